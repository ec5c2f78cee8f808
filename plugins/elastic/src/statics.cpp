#include "softpoint/elastic/statics.h"

#include <Eigen/Cholesky>

#include <string>

#include "hanging_field.h"
#include "instruction_set.h"
#include "memory.h"
#include "rigid_modes.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "static_loads.h"
#include "stopwatch.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kBalance = 1e-6;

void check_balance(const FreeRigidModes::Wrench& wrench) {
  if (wrench.relative > kBalance) {
    throw Error("loads are not balanced: net force " + to_text(wrench.force) + " N and moment " +
                to_text(wrench.moment) +
                " N m about the mean of the vertices along motions that nothing holds; " +
                "permitted is a remainder of 1e-6 of the loads: hold vertices or balance the loads");
  }
}

// Solves K u = f on the free degrees of freedom, K being E S there. Along free rigid motions, where K is
// singular and f has no part left, K is stiffened: the answer gains nothing along them.
Vector solve_free(const Eigen::Map<const Matrix>& unit_stiffness, double young, const FreeRigidModes& rigid,
                  const std::vector<Eigen::Index>& free, const Vector& load, const Kernels& kernels) {
  Matrix k = young * unit_stiffness(free, free);
  Vector f = load(free);
  if (rigid.count() > 0) {
    const Matrix modes = rigid.modes()(free, Eigen::all);
    f -= modes * (modes.transpose() * f);
    k.noalias() += (k.diagonal().mean() * modes) * modes.transpose();
  }
  std::vector<double> scratch(kernels.scratch);
  if (!kernels.cholesky(k.data(), k.rows(), k.rows(), scratch.data())) {
    throw Error(
        "displacement: the vertices held leave the body loose within rounding; permitted are "
        "holders further apart, or none");
  }
  const auto lower = k.triangularView<Eigen::Lower>();
  lower.solveInPlace(f);
  lower.adjoint().solveInPlace(f);
  return f;
}

struct Model {
  const BoundaryStiffness& stiffness;
  const StaticProblem& problem;
  Vec3 origin;

  Eigen::Index dofs() const { return stiffness.dofs(); }
  double young() const { return problem.material.young; }
  Vec3 body_force() const { return problem.material.density * problem.gravity; }
  Eigen::Map<const Matrix> unit_stiffness() const {
    return {stiffness.unit_stiffness.data(), dofs(), dofs()};
  }
  // u_p at the vertices.
  Vector hanging() const {
    Vector u(dofs());
    for (int v = 0; v < problem.mesh.vertex_count(); ++v) {
      u.segment<3>(3 * v) =
          hanging_displacement(problem.mesh.vertices[v] - origin, body_force() / young(), stiffness.poisson);
    }
    return u;
  }
};

std::vector<Vec3> as_points(const Vector& values) {
  std::vector<Vec3> points;
  for (Eigen::Index i = 0; i < values.size(); i += 3) points.emplace_back(values.segment<3>(i));
  return points;
}

// t = E V^-1 W (u - u_p) + sigma_p n at the centroids.
std::vector<Vec3> face_tractions(const Model& model, const Vector& without_hanging) {
  const TriangleMesh& mesh = model.problem.mesh;
  const Eigen::Map<const RowMatrix> unit_traction(model.stiffness.unit_traction.data(),
                                                  3 * mesh.triangle_count(), model.dofs());
  std::vector<Vec3> traction = as_points(model.young() * (unit_traction * without_hanging));
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vec3 centroid =
        (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0 - model.origin;
    traction[f] += hanging_stress(centroid, model.body_force()) * triangle_normal(mesh, f);
  }
  return traction;
}

StaticResult solve(const Model& model, const StaticLoads& loads) {
  const TriangleMesh& mesh = model.problem.mesh;
  Stopwatch watch;
  StaticResult result;
  const Eigen::Map<const Matrix> columns(model.stiffness.gravity_columns.data(), model.dofs(), 3);
  const Vector weight = columns * model.body_force();
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < model.dofs(); ++i) {
    if (!loads.held[i]) free.push_back(i);
  }
  const FreeRigidModes rigid(mesh, model.origin, loads.held);
  Vector applied = loads.nodal + weight;
  for (Eigen::Index i = 0; i < model.dofs(); ++i) {
    if (loads.held[i]) applied[i] = 0.0;
  }
  check_balance(rigid.resultant(applied));
  result.free_rigid_motions = rigid.count();

  Vector u = loads.displacement;
  if (!free.empty()) {
    const Vector load = applied - model.young() * (model.unit_stiffness() * u);
    u(free) = solve_free(model.unit_stiffness(), model.young(), rigid, free, load,
                         kernels_for(model.stiffness.instruction_set));
    rigid.remove_from(u, vertex_areas(mesh));
  }
  const Vector force = model.young() * (model.unit_stiffness() * u) - weight;
  Vector nodal = loads.nodal;
  for (Eigen::Index i = 0; i < model.dofs(); ++i) {
    if (loads.held[i]) nodal[i] = force[i] - loads.nodal[i];
  }
  // Equation (19): the strain energy of u_p + (u - u_p), the cross term by Betti's theorem.
  const Vector hanging = model.hanging();
  const Vector rest = u - hanging;
  result.energy =
      0.5 * model.young() * rest.dot(model.unit_stiffness() * (u + hanging)) +
      hanging_energy(mesh, model.origin, model.body_force(), model.stiffness.poisson) / model.young();
  result.displacement = as_points(u);
  result.nodal_force = as_points(nodal);
  result.seconds.solve = watch.lap();
  result.traction = face_tractions(model, rest);
  result.seconds.traction = watch.lap();
  return result;
}

bool same_mesh(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles;
}

}  // namespace

StaticResult solve_statics(const StaticProblem& problem, std::shared_ptr<const BoundaryStiffness> stiffness,
                           const StiffnessSettings& settings) {
  Stopwatch watch;
  check_closed(problem.mesh);
  check(problem.material);
  check_range("gravity", problem.gravity, -kMaxAcceleration, kMaxAcceleration);
  const StaticLoads loads = gather_loads(problem);
  if (stiffness == nullptr) {
    StiffnessSettings with_traction = settings;
    with_traction.keep_traction = true;
    stiffness = assemble_stiffness(problem.mesh, problem.material.poisson, with_traction);
  } else if (!same_mesh(stiffness->mesh, problem.mesh) || stiffness->poisson != problem.material.poisson ||
             stiffness->unit_traction.empty()) {
    throw Error(
        "stiffness: made for another mesh or Poisson's ratio, or without keep_traction; permitted is "
        "one of the problem's own mesh and material with the traction operator");
  }
  check_memory(problem.mesh, 72.0 * problem.mesh.vertex_count() * problem.mesh.vertex_count() + 1e6,
               settings.memory_limit);  // the free block of S
  const double assembling = watch.lap();
  StaticResult result = solve({*stiffness, problem, mean_vertex(problem.mesh)}, loads);
  result.seconds.stiffness = stiffness->seconds;
  result.seconds.total = assembling + watch.lap();
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
