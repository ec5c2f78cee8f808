// Energy and forces of joined segments as laws: forces are the gradient, they balance, and they turn along.
#include <gtest/gtest.h>

#include "elastic_support.h"
#include "part_mechanics.h"
#include "support/characters.h"

namespace softpoint::elastic {
namespace {

// Every point through x -> turn x + shift.
Vector turned(const PartGroup& group, const Vector& x, const Mat3& turn, const Vec3& shift) {
  Vector y = x;
  for (const PartGroup::Joint& joint : group.joints()) {
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      const Vec3 p = turn * group.point(x, 3 * joint.first + i, joint.count) + shift;
      for (int a = 0; a < 3; ++a) y[3 * joint.first + a * joint.count + i] = p[a];
    }
  }
  return y;
}

// Bent, dented and turned: nothing is small.
Vector shape_of(const PartGroup& group, Noise& noise, double dent = 0.06) {
  Vector x = group.rest();
  for (double& v : x) v += dent * noise();
  return turned(group, x, turned_about(Vec3(noise(), noise(), noise()), 2.5 * noise()),
                Vec3(noise(), noise(), noise()));
}

struct Resultant {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double force_scale = 0, moment_scale = 0;
};

Resultant resultant_of(const PartGroup& group, const Vector& x, const Vector& f) {
  Resultant sum;
  for (const PartGroup::Joint& joint : group.joints()) {
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      const Vec3 p = group.point(x, 3 * joint.first + i, joint.count);
      const Vec3 q = group.point(f, 3 * joint.first + i, joint.count);
      sum.force += q;
      sum.moment += p.cross(q);
      sum.force_scale += q.norm();
      sum.moment_scale += p.norm() * q.norm();
    }
  }
  return sum;
}

std::vector<AssemblyDesign> designs() {
  const BoneSettings bone{.length_stiffness = 3e4, .angle_stiffness = 2e3};
  AssemblyDesign mixed = chain_of(2);
  mixed.parts[0].segments.push_back(cylinder_segment(3e5, 8, 2.0));
  mixed.parts[0].bone = bone;
  return {chain_of(1), chain_of(3, cylinder_segment(), bone), mixed, branched_figure(1e5, bone)};
}

void load(PartGroup& group, Noise& noise) {
  group.gravity = Vec3(2, -9, 4);
  for (int s = 0; s < static_cast<int>(group.segments().size()); ++s) {
    group.pushes.push_back({s, 3, 100.0 * Vec3(noise(), noise(), noise())});
    group.pushes.push_back({s, 7, 100.0 * Vec3(noise(), noise(), noise())});
  }
  for (double& v : group.loads) v = 20.0 * noise();
}

TEST(PartGroup, ForcesAreTheGradientOfTheEnergy) {
  Noise noise;
  int index = 0;
  for (const AssemblyDesign& design : designs()) {
    for (const int kind : {0, 1, 2, 3}) {
      const bool loaded = kind % 2 == 1, turned = kind >= 2;
      Mechanics m(design);
      if (turned) m.group.turn_surfaces(true);
      if (loaded) load(m.group, noise);
      const Vector x = shape_of(m.group, noise);
      Vector gradient(m.group.size()), scratch(m.group.size());
      m.group.evaluate(x, gradient);
      for (int trial = 0; trial < 6; ++trial) {
        Vector way(m.group.size());
        for (double& v : way) v = noise();
        // Richardson's extrapolation of central differences.
        const auto slope = [&](double h) {
          return (m.group.evaluate(x + h * way, scratch) - m.group.evaluate(x - h * way, scratch)) / (2 * h);
        };
        const double found = (4 * slope(5e-5) - slope(1e-4)) / 3;
        EXPECT_NEAR(found, gradient.dot(way), 1e-7 * gradient.norm() * way.norm())
            << "design " << index << (loaded ? ", loaded" : "") << (turned ? ", surfaces turned" : "");
      }
    }
    ++index;
  }
}

TEST(PartGroup, InnerForcesHaveNoResultantAtAnyShape) {
  Noise noise;
  for (const AssemblyDesign& design : designs()) {
    for (const double dent : {0.01, 0.1, 0.4}) {
      Mechanics m(design);
      const Vector x = shape_of(m.group, noise, dent);
      Vector gradient(m.group.size());
      m.group.evaluate(x, gradient);
      const Resultant sum = resultant_of(m.group, x, gradient);
      EXPECT_LT(sum.force.norm(), 1e-12 * sum.force_scale);
      EXPECT_LT(sum.moment.norm(), 1e-11 * sum.moment_scale);
    }
  }
}

// Dead loads weigh on the whole with themselves, no more: pushes, weight.
TEST(PartGroup, OuterForcesArriveWhole) {
  Noise noise;
  for (const AssemblyDesign& design : designs()) {
    Mechanics m(design);
    load(m.group, noise);
    const Vector x = shape_of(m.group, noise);
    Vec3 expected = Vec3::Zero();
    for (const SkinPush& push : m.group.pushes) expected += push.force;
    expected += resultant_of(m.group, x, m.group.loads).force;
    for (const PartGroup::Segment& s : m.group.segments()) {
      expected += m.models[static_cast<std::size_t>(s.model)]->model->mass * m.group.gravity;
    }
    Vector gradient(m.group.size());
    m.group.evaluate(x, gradient);
    const Resultant sum = resultant_of(m.group, x, gradient);
    EXPECT_LT((sum.force + expected).norm(), 1e-11 * (sum.force_scale + expected.norm()));
  }
}

TEST(PartGroup, TurnedShapesHaveTheSameEnergyAndTurnedForces) {
  Noise noise;
  for (const AssemblyDesign& design : designs()) {
    Mechanics m(design);
    const Vector x = shape_of(m.group, noise);
    Vector gradient(m.group.size()), other(m.group.size());
    const double energy = m.group.evaluate(x, gradient);
    for (int trial = 0; trial < 4; ++trial) {
      const Mat3 turn = turned_about(Vec3(noise(), noise(), noise()), 3.0 * noise());
      const Vec3 shift(5 * noise(), 5 * noise(), 5 * noise());
      EXPECT_NEAR(m.group.evaluate(turned(m.group, x, turn, shift), other), energy, 1e-11 * energy);
      EXPECT_LT((other - turned(m.group, gradient, turn, Vec3::Zero())).norm(), 1e-10 * gradient.norm());
    }
  }
}

TEST(PartGroup, AtRestThereIsNeitherForceNorEnergy) {
  for (const AssemblyDesign& design : designs()) {
    Mechanics m(design);
    Vector gradient(m.group.size());
    const Vector x = turned(m.group, m.group.rest(), turned_about(Vec3(1, 2, 3), 2.0), Vec3(1, 2, 3));
    const double energy = m.group.evaluate(x, gradient);
    EXPECT_LT(energy, 1e-20 * m.group.stiffness_scale());
    EXPECT_LT(gradient.norm(), 1e-12 * m.group.stiffness_scale());
  }
}

// The product is the change of the forces: exact at rest, where frames that turn carry no force.
TEST(PartGroup, StiffnessIsTheSlopeOfTheForcesAtRest) {
  Noise noise;
  for (const AssemblyDesign& design : designs()) {
    Mechanics m(design);
    const Eigen::Index n = m.group.size();
    Vector way(n), up(n), down(n), product(n);
    for (double& v : way) v = noise();
    const double h = 1e-6;
    m.group.evaluate(m.group.rest() + h * way, up);
    m.group.evaluate(m.group.rest() - h * way, down);
    Vector ignored(n);
    m.group.evaluate(m.group.rest(), ignored);
    m.group.stiffness_product(way, product);
    EXPECT_LT(((up - down) / (2 * h) - product).norm(), 1e-5 * product.norm());
    // And of the blocks that are factored.
    const std::vector<char> nothing(static_cast<std::size_t>(m.group.points()), 0);
    const BlockRows rows = m.group.rest_stiffness(nothing, Vector::Zero(m.group.points()));
    Vector by_blocks = Vector::Zero(n);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& to = m.group.joints()[i];
      for (const auto& [j, block] : rows[i]) {
        const auto& from = m.group.joints()[j];
        by_blocks.segment(3 * to.first, 3 * to.count) += block * way.segment(3 * from.first, 3 * from.count);
      }
    }
    EXPECT_LT((by_blocks - product).norm(), 1e-11 * product.norm());
  }
}

TEST(PartGroup, SingleAgreesWithDoubleToItsRounding) {
  Noise noise, again;
  for (const AssemblyDesign& design : designs()) {
    Mechanics m(design), s(design, true);
    load(m.group, noise);
    load(s.group, again);
    Vector in_double(m.group.size()), in_single(m.group.size());
    const double energy = m.group.evaluate(shape_of(m.group, noise), in_double);
    const double other = s.group.evaluate(shape_of(s.group, again), in_single);
    EXPECT_LT((in_single - in_double).norm(), 1e-6 * in_double.norm());
    EXPECT_NEAR(other, energy, 1e-6 * std::abs(energy));
  }
}

// Points on a line, on a plane, in one place, mirrored: nothing that is not a number comes out.
TEST(PartGroup, FlattenedShapesStayFinite) {
  for (const AssemblyDesign& design : designs()) {
    for (const Vec3& squeeze :
         {Vec3(1, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, 0), Vec3(-1, 1, 1), Vec3(-1, -1, -1)}) {
      Mechanics m(design);
      const Vector x = turned(m.group, m.group.rest(), Mat3(squeeze.asDiagonal()), Vec3::Zero());
      Vector gradient(m.group.size());
      EXPECT_TRUE(std::isfinite(m.group.evaluate(x, gradient)));
      EXPECT_TRUE(gradient.allFinite());
    }
  }
}

}  // namespace
}  // namespace softpoint::elastic
