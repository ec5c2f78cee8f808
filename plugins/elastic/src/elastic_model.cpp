#include "softpoint/elastic/elastic_model.h"

#include <Eigen/Cholesky>

#include <algorithm>

#include "instruction_set.h"
#include "softpoint/core/error.h"
#include "symmetric_layout.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void check(const ElasticSettings& settings) {
  check_range("ElasticSettings.time_step", settings.time_step, 1e-6, 1.0);
  check(settings.stiffness);
  check(settings.cache);
}

namespace {

// Rounding in h^2 S must stay small against the masses, or M + h^2 S is no longer positive definite.
void check_stiffness(const ElasticModel& model) {
  constexpr double kLargestRatio = 1e12;
  const Eigen::Index n = model.dofs();
  const Eigen::Map<const Eigen::MatrixXd> unit(model.stiffness->unit_stiffness.data(), n, n);
  const double mass = *std::min_element(model.masses.begin(), model.masses.end());
  const double h = model.time_step;
  const double stiffest = kLargestRatio * mass / (h * h * unit.diagonal().maxCoeff());
  if (!(model.material.young <= stiffest)) {
    throw Error("material.young = " + to_text(model.material.young) + ": permitted is up to " +
                to_text(stiffest) + " with this mesh, density and time step");
  }
}

}  // namespace

std::shared_ptr<const ElasticModel> make_elastic_model(const TriangleMesh& mesh, const Material& material,
                                                       const ElasticSettings& settings) {
  check(settings);
  check(material);
  const MeshReport report = check_closed(mesh, "elastic body");
  auto model = std::make_shared<ElasticModel>();
  model->mesh = mesh;
  model->material = material;
  model->time_step = settings.time_step;
  model->volume = report.volume;
  model->stiffness = load_or_assemble_stiffness(mesh, material.poisson, settings.stiffness, settings.cache);
  model->masses = vertex_areas(mesh);
  const double mass = material.density * report.volume;
  for (std::size_t v = 0; v < model->masses.size(); ++v) {
    model->masses[v] *= mass / report.area;
    model->center += model->masses[v] / mass * mesh.vertices[v];
  }
  for (const Vec3& vertex : mesh.vertices) {
    model->rest.push_back(vertex - model->center);
  }
  model->normals.assign(mesh.vertices.size(), Vec3::Zero());
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    for (const int v : mesh.triangles[static_cast<std::size_t>(f)]) {
      model->normals[static_cast<std::size_t>(v)] += triangle_area(mesh, f) * triangle_normal(mesh, f);
    }
  }
  for (Vec3& normal : model->normals) {
    normal.normalize();
  }
  check_stiffness(*model);
  compute_response(*model, settings.time_step, model->response);
  if (settings.single_precision) {
    model->single_response =
        pack_symmetric(kernels_for(model->stiffness->instruction_set), model->response, model->dofs());
  }
  return model;
}

void compute_response(const ElasticModel& model, double h, std::vector<double>& response) {
  const Eigen::Index n = model.dofs();
  const Eigen::Map<const Eigen::MatrixXd> unit(model.stiffness->unit_stiffness.data(), n, n);
  Eigen::MatrixXd a = h * h * model.material.young * unit;
  for (Eigen::Index i = 0; i < n; ++i) {
    a(i, i) += model.masses[static_cast<std::size_t>(i / 3)];
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(a);  // in place
  response.resize(static_cast<std::size_t>(n * n));
  Eigen::Map<Eigen::MatrixXd> inverse(response.data(), n, n);
  inverse.setIdentity();
  factor.solveInPlace(inverse);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
