#include "softpoint/elastic/segment_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <string>

#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

void check_interface(const TriangleMesh& mesh, const std::vector<int>& interface, const std::string& name,
                     std::vector<char>& taken) {
  if (interface.size() < 3) {
    throw Error(name + " has " + std::to_string(interface.size()) + " vertices; permitted are 3 or more");
  }
  Vec3 mean = Vec3::Zero();
  for (const int v : interface) {
    check_index(name + ": vertex", v, mesh.vertex_count());
    if (taken[static_cast<std::size_t>(v)] != 0) {
      throw Error(name + ": vertex " + std::to_string(v) +
                  " is named twice; permitted is one interface for a vertex");
    }
    taken[static_cast<std::size_t>(v)] = 1;
    mean += mesh.vertices[static_cast<std::size_t>(v)] / static_cast<double>(interface.size());
  }
  Mat3 spread = Mat3::Zero();
  for (const int v : interface) {
    const Vec3 arm = mesh.vertices[static_cast<std::size_t>(v)] - mean;
    spread += arm * arm.transpose();
  }
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues();
  if (!(values[1] > 1e-8 * values[2])) {
    throw Error(name + ": its vertices lie on a line; permitted are those that span a surface");
  }
}

// Rows of vertex-major degrees of freedom, in axis-major order of `vertices`.
std::vector<Eigen::Index> axis_major(const std::vector<int>& vertices) {
  std::vector<Eigen::Index> rows;
  rows.reserve(3 * vertices.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const int v : vertices) {
      rows.push_back(3 * v + axis);
    }
  }
  return rows;
}

std::vector<double> stored(const Eigen::MatrixXd& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

}  // namespace

std::shared_ptr<const SegmentModel> make_segment_model(const TriangleMesh& mesh,
                                                       const std::vector<std::vector<int>>& interfaces,
                                                       const Material& material,
                                                       const SegmentSettings& settings) {
  check(material);
  check(settings.stiffness);
  check(settings.cache);
  const MeshReport report = check_closed(mesh, "segment");
  if (interfaces.empty()) {
    throw Error("segment: interfaces is empty; permitted are one or more");
  }
  std::vector<char> taken(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    check_interface(mesh, interfaces[i], "segment: interface " + std::to_string(i), taken);
  }
  auto model = std::make_shared<SegmentModel>();
  model->mesh = mesh;
  model->material = material;
  model->interfaces = interfaces;
  model->volume = report.volume;
  model->mass = material.density * report.volume;
  for (const std::vector<int>& interface : interfaces) {
    model->joint_vertices.insert(model->joint_vertices.end(), interface.begin(), interface.end());
  }
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (taken[static_cast<std::size_t>(v)] == 0) model->free_vertices.push_back(v);
  }

  const auto whole = load_or_assemble_stiffness(mesh, material.poisson, settings.stiffness, settings.cache);
  const Eigen::Index n = whole->dofs();
  const Eigen::Map<const Eigen::MatrixXd> s(whole->unit_stiffness.data(), n, n);
  const Eigen::Map<const Eigen::MatrixXd> g(whole->gravity_columns.data(), n, 3);
  const auto joint = axis_major(model->joint_vertices), free = axis_major(model->free_vertices);
  // Elimination of the free vertices: S_ff u_f = f_f - S_fc u_c.
  const Eigen::MatrixXd s_fc = s(free, joint), g_f = g(free, Eigen::all);
  const Eigen::LLT<Eigen::MatrixXd> factor(s(free, free));
  const Eigen::MatrixXd response = -factor.solve(s_fc);
  const Eigen::MatrixXd k = s(joint, joint) + s_fc.transpose() * response;
  const double young = material.young;
  model->stiffness = stored(0.5 * young * (k + k.transpose()));
  model->free_response = stored(response);
  const auto free_count = static_cast<Eigen::Index>(free.size());
  const Eigen::MatrixXd compliance = factor.solve(Eigen::MatrixXd::Identity(free_count, free_count));
  model->free_compliance = stored(0.5 / young * (compliance + compliance.transpose()));
  model->joint_weight = stored(g(joint, Eigen::all) + response.transpose() * g_f);
  model->free_sag = stored(factor.solve(g_f) / young);
  return model;
}

std::shared_ptr<const SegmentModel> make_prism_segment(int sides, int stacks, double radius, double length,
                                                       const Material& material,
                                                       const SegmentSettings& settings) {
  const TriangleMesh mesh = prism(sides, stacks, 1, radius, length);
  // Lower centre, rings upward, upper centre.
  std::vector<int> lower = {0}, upper = {mesh.vertex_count() - 1};
  for (int i = 0; i < sides; ++i) {
    lower.push_back(1 + i);
    upper.push_back(1 + sides * stacks + i);
  }
  return make_segment_model(mesh, {lower, upper}, material, settings);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
