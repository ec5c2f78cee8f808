#pragma once

#include <Eigen/Dense>

#include <array>
#include <memory>
#include <vector>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/elastic/boundary_stiffness.h"
#include "support/bar_mesh.h"
#include "support/whole_bar_reference.h"

// One whole bar with both caps clamped to rigid plates, linear, by the library's boundary elements.
namespace softpoint::reference {

struct WholeBar {
  BarStiffness stiffness;
  double shear =
      0;  // force over the sideways shift of one plate against the other, neither turned, m; E = 1 Pa
  Eigen::MatrixXd displacement;  // 3V x 4: stretched by 1 m, twisted, bent by 1 rad, sheared by 1 m
};

// Each plate takes half of the motion.
inline WholeBar solve_whole_bar(const TriangleMesh& mesh, const std::vector<int>& bottom,
                                const std::vector<int>& top, double poisson) {
  const auto model = elastic::assemble_stiffness(mesh, poisson);
  const int dofs = model->dofs();
  const Eigen::Map<const Eigen::MatrixXd> s(model->unit_stiffness.data(), dofs, dofs);

  WholeBar bar;
  Eigen::MatrixXd& u = bar.displacement;
  u = Eigen::MatrixXd::Zero(dofs, 4);
  std::vector<char> held(dofs, 0);
  for (const auto* cap : {&bottom, &top}) {
    const double sign = cap == &top ? 0.5 : -0.5;
    for (int v : *cap) {
      const Vec3 x = mesh.vertices[v];
      for (int k = 0; k < 3; ++k) held[3 * v + k] = 1;
      u(3 * v + 2, 0) = sign;
      u(3 * v, 1) = -sign * x.y();
      u(3 * v + 1, 1) = sign * x.x();
      u(3 * v + 2, 2) = -sign * x.x();
      u(3 * v, 3) = sign;
    }
  }
  std::vector<int> free_dofs, held_dofs;
  for (int i = 0; i < dofs; ++i) (held[i] ? held_dofs : free_dofs).push_back(i);
  const Eigen::MatrixXd given = u(held_dofs, Eigen::all);
  {
    Eigen::MatrixXd kff = s(free_dofs, free_dofs);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(kff);
    const Eigen::MatrixXd load = s(free_dofs, held_dofs) * given;
    const Eigen::MatrixXd found = factor.solve(load);
    u(free_dofs, Eigen::all) = -found;
  }
  // Twice the strain energy: the stiffness of each motion.
  const Eigen::MatrixXd forces = s(held_dofs, Eigen::all) * u;
  const auto stiffness = [&](int c) { return given.col(c).dot(forces.col(c)); };
  bar.stiffness = {stiffness(0), stiffness(1), stiffness(2)};
  bar.shear = stiffness(3);
  return bar;
}

inline WholeBar solve_refined_bar(int parts, int level, double poisson) {
  const RefinedBar bar = refined_bar(parts, level);
  return solve_whole_bar(bar.mesh, bar.bottom, bar.top, poisson);
}

}  // namespace softpoint::reference
