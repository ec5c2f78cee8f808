#pragma once

#include <Eigen/Dense>

#include <span>
#include <vector>

#include "softpoint/elastic/elastic_body.h"

namespace softpoint {

// Springs between some vertices of a body, linear in a frame that turns with them: what hangs on a body at
// several points. Neither pushes nor turns the body as a whole.
struct SpringNet {
  SpringNet(const elastic::ElasticBody& body, std::vector<int> vertices, Eigen::MatrixXd local_stiffness)
      : points(std::move(vertices)), local(std::move(local_stiffness)) {
    for (const int p : points) {
      rest.push_back(body.points()[static_cast<std::size_t>(p)]);
    }
    const Vec3 middle = mean(rest);
    for (Vec3& r : rest) r -= middle;
  }

  static Vec3 mean(const std::vector<Vec3>& all) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : all) sum += p;
    return sum / double(all.size());
  }

  // Fills `forces`, the stiffness turned along and the energy (J).
  void update(const elastic::ElasticBody& body) {
    const std::size_t n = points.size();
    std::vector<Vec3> now;
    for (const int p : points) now.push_back(body.points()[static_cast<std::size_t>(p)]);
    const Vec3 middle = mean(now);
    Mat3 moment = Mat3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      now[i] -= middle;
      moment += now[i] * rest[i].transpose();
    }
    const Eigen::JacobiSVD<Mat3> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double mirror = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    const Mat3 turn = svd.matrixU() * Vec3(1, 1, mirror).asDiagonal() * svd.matrixV().transpose();
    const auto rows = static_cast<Eigen::Index>(3 * n);
    Eigen::MatrixXd turned = local, modes(rows, 6);
    Eigen::VectorXd u(rows);
    for (std::size_t i = 0; i < n; ++i) {
      const auto r = static_cast<Eigen::Index>(3 * i);
      u.segment<3>(r) = now[i] - turn * rest[i];
      for (std::size_t j = 0; j < n; ++j) {
        const auto c = static_cast<Eigen::Index>(3 * j);
        turned.block<3, 3>(r, c) = turn * local.block<3, 3>(r, c) * turn.transpose();
      }
      for (int a = 0; a < 3; ++a) {
        modes.col(a).segment<3>(r) = Vec3::Unit(a);
        modes.col(3 + a).segment<3>(r) = Vec3::Unit(a).cross(now[i]);
      }
    }
    // The motion of the points as a whole does not count, so neither do its forces.
    const Eigen::MatrixXd q = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(modes).householderQ() *
                              Eigen::MatrixXd::Identity(rows, 6);
    const auto shape = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      const Eigen::VectorXd once = x - q * (q.transpose() * x);
      return once - q * (q.transpose() * once);
    };
    const Eigen::VectorXd f = -shape(turned * shape(u));
    energy = -0.5 * f.dot(u);
    forces.clear();
    for (std::size_t i = 0; i < n; ++i) forces.push_back(f.segment<3>(static_cast<Eigen::Index>(3 * i)));
    stiffness = turned;
  }

  // For the coming step; `share` of the true stiffness is told.
  void load(elastic::ElasticBody& body, double share = 1.0) {
    update(body);
    told = share * stiffness;
    body.set_point_loads(points, forces, {told.data(), static_cast<std::size_t>(told.size())});
  }

  std::vector<int> points;
  Eigen::MatrixXd local;
  std::vector<Vec3> rest, forces;
  Eigen::MatrixXd stiffness, told;
  double energy = 0;
};

}  // namespace softpoint
