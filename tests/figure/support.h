#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "softpoint/figure/figure_model.h"

namespace softpoint::figure {

inline std::string data_file(const std::string& name) {
  return std::string(SOFTPOINT_FIGURE_DATA) + "/" + name;
}

// Rows of a CSV file without its header.
inline std::vector<std::vector<double>> read_rows(const std::string& name) {
  std::ifstream file(data_file(name));
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    rows.emplace_back();
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

// The state that a row of a reference with the humanoid of mjhum27.amdl holds.
inline FigureState humanoid_state(const FigureModel& model, const std::vector<double>& row) {
  FigureState state = rest_state(model);
  std::copy_n(&row[5], 3, &state.q[0]);
  std::copy_n(&row[1], 4, &state.q[3]);
  std::copy_n(&row[14], 21, &state.q[7]);
  std::copy_n(&row[8], 6, &state.qd[0]);
  std::copy_n(&row[35], 21, &state.qd[6]);
  return state;
}

// Trees of all kinds of joints, with armatures, friction and links fixed to others.
class RandomFigures {
 public:
  explicit RandomFigures(unsigned seed) : random_(seed) {}

  FigureModel model(int links, bool floating) {
    std::vector<Link> result;
    for (int i = 0; i < links; ++i) {
      Link link;
      link.name = "link" + std::to_string(i);
      link.parent = i == 0 ? -1 : static_cast<int>(random_() % static_cast<unsigned>(i));
      constexpr JointKind kKinds[] = {JointKind::kHinge, JointKind::kHinge, JointKind::kBall,
                                      JointKind::kPrismatic, JointKind::kFixed};
      link.joint = i == 0 ? (floating ? JointKind::kFree : JointKind::kHinge) : kKinds[random_() % 5];
      link.axis = vector();
      link.origin = 0.5 * vector();
      link.orientation = turn();
      link.mass = 0.1 + std::abs(normal_(random_));
      link.center_of_mass = 0.2 * vector();
      const Vec3 size = Vec3(0.1, 0.1, 0.1) + vector().cwiseAbs();  // principal second moments of mass
      const Mat3 axes = turn();
      link.inertia = 0.05 * link.mass * axes *
                     Vec3(size.y() + size.z(), size.z() + size.x(), size.x() + size.y()).asDiagonal() *
                     axes.transpose();
      link.armature = random_() % 3 == 0 ? 0.05 : 0.0;
      link.damping = random_() % 2 == 0 ? 0.3 : 0.0;
      result.push_back(link);
    }
    return FigureModel(result);
  }

  FigureState state(const FigureModel& model) {
    FigureState state = rest_state(model);
    for (double& x : state.q) x = normal_(random_);
    for (double& x : state.qd) x = normal_(random_);
    check_state(model, state);
    return state;
  }

  std::vector<double> numbers(int count) {
    std::vector<double> result(static_cast<std::size_t>(count));
    for (double& x : result) x = normal_(random_);
    return result;
  }

  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Mat3 turn() {
    return Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_), normal_(random_))
        .normalized()
        .toRotationMatrix();
  }
  bool coin() { return random_() % 2 == 0; }
  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace softpoint::figure
