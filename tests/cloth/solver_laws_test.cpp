// What the sweeps rest on: gradients, Hessians, colours.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <set>

#include "softpoint/core/instruction_set.h"
#include "softpoint/core/shapes.h"
#include "sweep_arrays.h"
#include "sweep_kernels.h"

namespace softpoint::cloth {
namespace {

Fabric laws_fabric() {
  Fabric fabric;
  fabric.bending_stiffness = 1e-3;
  fabric.compression_ratio = 0.3;
  return fabric;
}

// A grid, a closed surface and an open one that is no grid.
std::vector<ClothPattern> laws_patterns() {
  TriangleMesh half = sphere(0.1, 2);
  std::erase_if(half.triangles, [&half](const Triangle& t) {
    return half.vertices[t[0]].z() + half.vertices[t[1]].z() + half.vertices[t[2]].z() < -0.08;
  });
  std::vector<int> number(half.vertices.size(), -1);
  TriangleMesh open;
  for (Triangle t : half.triangles) {
    for (int k = 0; k < 3; ++k) {
      int& n = number[t[k]];
      if (n < 0) n = open.vertex_count(), open.vertices.push_back(half.vertices[t[k]]);
      t[k] = n;
    }
    open.triangles.push_back(t);
  }
  return {square_pattern(9, 7, 0.08, 0.06, laws_fabric()), mesh_pattern(sphere(0.1, 2), laws_fabric()),
          mesh_pattern(open, laws_fabric())};
}

std::vector<const SweepKernelTable*> kernel_tables() {
  std::vector<const SweepKernelTable*> tables = {sweep_kernels_baseline()};
  if (best_instruction_set() >= InstructionSet::kAvx2) tables.push_back(sweep_kernels_avx2());
  if (best_instruction_set() >= InstructionSet::kAvx512) tables.push_back(sweep_kernels_avx512());
  return tables;
}

// The arrays of a sweep, filled by hand, and the energy they stand for by formulas of its own.
class Laws {
 public:
  using A = SweepArrays<double>;

  Laws(const ClothPattern& pattern, double stretch, unsigned seed)
      : pattern_(pattern),
        layout(pattern),
        arrays(layout),
        data(arrays.data(laws_fabric().compression_ratio)) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shake(-0.1 * pattern.spacing, 0.1 * pattern.spacing);
    const auto shaken = [&](const Vec3& p) {
      return Vec3(p + Vec3(shake(random), shake(random), shake(random)));
    };
    std::fill_n(arrays.tile_pocket.get(), arrays.slots / kTile, 0);
    std::fill_n(arrays.slot_pocket.get(), arrays.slots, -1);
    std::fill_n(arrays.field(A::kInertia), arrays.slots, kInertia);
    for (int p = 0; p < pattern.point_count(); ++p) {
      x.push_back(shaken(stretch * pattern.points[p]));
      target.push_back(shaken(x.back()));
      start.push_back(shaken(x.back()));
      const int slot = layout.slot_of[p];
      put(A::kX, slot, x[p]), put(A::kT, slot, target[p] - start[p]), put(A::kS, slot, start[p]);
      arrays.field(A::kFree)[slot] = 1;
      arrays.slot_pocket[slot] = 0;
    }
    for (const ColourPlan& plan : layout.colours) {
      for (long group = 0; group < static_cast<long>(plan.tiles) * plan.ring; ++group) {
        double* out = arrays.springs.get() + plan.spring_at + group * 4 * kTile;
        for (int lane = 0; lane < kTile; ++lane) {
          const int of = layout.spring_of[plan.spring_at / 4 + group * kTile + lane];
          if (of < 0) continue;
          out[lane] = pattern.springs[of].stiffness;
          out[kTile + lane] = pattern.springs[of].rest;
          out[2 * kTile + lane] = kDamping * pattern.springs[of].stiffness;
        }
      }
    }
    for (std::size_t i = 0; i < layout.face_of.size(); ++i)
      arrays.face_weight[i] = layout.face_of[i] < 0 ? 0 : 1. / 6;
  }

  void gather(const SweepKernelTable& table) {
    PocketSums sums;
    for (const ColourPlan& plan : layout.colours)
      table.dual.measure_dampers(data, plan, arrays.springs.get());
    for (const ColourPlan& plan : layout.colours) table.dual.gather(data, plan, true, &sums);
  }
  Vec3 vector(int field, int point) const {
    const int slot = layout.slot_of[point];
    return Vec3(arrays.field(field)[slot], arrays.field(field + 1)[slot], arrays.field(field + 2)[slot]);
  }
  Mat3 hessian(int point) const {
    const double* h = arrays.field(A::kH) + layout.slot_of[point];
    const long n = arrays.slots;
    Mat3 out;
    out << h[0], h[3 * n], h[4 * n], h[3 * n], h[n], h[5 * n], h[4 * n], h[5 * n], h[2 * n];
    return out;
  }

  // The energy's slope at a point by (2) and (3), one term after the other.
  Vec3 slope(int point, const std::vector<Vec3>& at) const {
    Vec3 g = kInertia * (at[point] - target[point]);
    for (const Spring& s : pattern_.springs) {
      if (s.a != point && s.b != point) continue;
      const Vec3 arm = at[s.a == point ? s.b : s.a] - at[point];
      const double longer = arm.norm() - s.rest;
      const double k = longer > 0 ? s.stiffness : laws_fabric().compression_ratio * s.stiffness;
      const double damped = kDamping * s.stiffness * (arm.norm() - (start[s.a] - start[s.b]).norm());
      g -= (k * longer + damped) * arm.normalized();
    }
    for (const BendElement& b : pattern_.bends) {
      Vec3 sum = Vec3::Zero();
      for (int k = 0; k < 4; ++k) sum += b.weight[k] * at[b.point[k]];
      for (int k = 0; k < 4; ++k) {
        if (b.point[k] == point) g += b.stiffness * b.weight[k] * sum;
      }
    }
    return g;
  }
  double energy(const std::vector<Vec3>& at) const {
    double e = 0;
    for (std::size_t p = 0; p < at.size(); ++p) e += 0.5 * kInertia * (at[p] - target[p]).squaredNorm();
    for (const Spring& s : pattern_.springs) {
      const double length = (at[s.a] - at[s.b]).norm(), longer = length - s.rest;
      const double k = longer > 0 ? s.stiffness : laws_fabric().compression_ratio * s.stiffness;
      e += 0.5 * k * longer * longer +
           0.5 * kDamping * s.stiffness * std::pow(length - (start[s.a] - start[s.b]).norm(), 2);
    }
    for (const BendElement& b : pattern_.bends) {
      Vec3 sum = Vec3::Zero();
      for (int k = 0; k < 4; ++k) sum += b.weight[k] * at[b.point[k]];
      e += 0.5 * b.stiffness * sum.squaredNorm();
    }
    return e;
  }
  double volume(const std::vector<Vec3>& at) const {
    double v = 0;
    for (const Triangle& t : pattern_.faces) v += at[t[0]].dot(at[t[1]].cross(at[t[2]])) / 6;
    return v;
  }

  static constexpr double kInertia = 30, kDamping = 0.2;

 private:
  void put(int field, int slot, const Vec3& v) {
    for (int k = 0; k < 3; ++k) arrays.field(field + k)[slot] = v[k];
  }
  const ClothPattern& pattern_;

 public:
  SweepLayout layout;
  A arrays;
  SweepData<double> data;
  std::vector<Vec3> x, target, start;
};

TEST(SolverLaws, NodalGradientIsTheSlopeOfTheEnergy) {
  for (const ClothPattern& pattern : laws_patterns()) {
    for (const double stretch : {0.9, 1.0, 1.3}) {
      Laws laws(pattern, stretch, 1);
      for (const SweepKernelTable* table : kernel_tables()) {
        laws.gather(*table);
        for (int p = 0; p < pattern.point_count(); p += 3) {
          const Vec3 g = laws.vector(Laws::A::kG, p);
          EXPECT_LT((g - laws.slope(p, laws.x)).norm(), 1e-9 * (1 + g.norm()));
          for (int c = 0; c < 3; ++c) {
            std::vector<Vec3> up = laws.x, down = laws.x;
            const double d = 1e-6 * pattern.spacing;
            up[p][c] += d, down[p][c] -= d;
            EXPECT_NEAR(g[c], (laws.energy(up) - laws.energy(down)) / (2 * d), 1e-4 * (1 + g.norm()));
          }
        }
      }
    }
  }
}

// Of taut springs to the last term but that of dampers across their spring, which is left out; of slack ones
// never less than the inertia.
TEST(SolverLaws, NodalHessianIsTheSlopeOfTheGradient) {
  for (const ClothPattern& pattern : laws_patterns()) {
    for (const double stretch : {0.7, 1.6}) {
      Laws laws(pattern, stretch, 2);
      laws.start = laws.x;  // dampers without force
      for (int p = 0; p < pattern.point_count(); ++p) {
        for (int c = 0; c < 3; ++c) laws.arrays.field(Laws::A::kS + c)[laws.layout.slot_of[p]] = laws.x[p][c];
      }
      for (const SweepKernelTable* table : kernel_tables()) {
        laws.gather(*table);
        for (int p = 0; p < pattern.point_count(); p += 3) {
          const Mat3 h = laws.hessian(p);
          Mat3 slope;
          for (int c = 0; c < 3; ++c) {
            std::vector<Vec3> up = laws.x, down = laws.x;
            const double d = 1e-5 * pattern.spacing;
            up[p][c] += d, down[p][c] -= d;
            slope.col(c) = (laws.slope(p, up) - laws.slope(p, down)) / (2 * d);
          }
          if (stretch > 1) {
            EXPECT_LT((h - slope).norm(), 1e-6 * h.norm());
          } else {
            const Eigen::Matrix3d more = h - slope;
            EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(more).eigenvalues()[0],
                      -1e-6 * h.norm());
            EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Matrix3d(h)).eigenvalues()[0],
                      (1 - 1e-9) * Laws::kInertia);
          }
        }
      }
    }
  }
}

TEST(SolverLaws, VolumeGradientOfAClosedSurface) {
  const ClothPattern pattern = laws_patterns()[1];
  Laws laws(pattern, 1.1, 3);
  for (const SweepKernelTable* table : kernel_tables()) {
    laws.gather(*table);
    for (int p = 0; p < pattern.point_count(); ++p) {
      const Vec3 area = laws.vector(Laws::A::kV, p);
      for (int c = 0; c < 3; ++c) {
        std::vector<Vec3> up = laws.x, down = laws.x;
        up[p][c] += 1e-3, down[p][c] -= 1e-3;  // linear: any step is exact
        EXPECT_NEAR(area[c], (laws.volume(up) - laws.volume(down)) / 2e-3, 1e-12);
      }
    }
  }
}

TEST(SolverLaws, NoSpringAndNoTriangleHasTwoPointsOfOneColour) {
  std::vector<ClothPattern> patterns = laws_patterns();
  patterns.push_back(square_pattern(50, 50, 0.3, 0.3, laws_fabric()));
  for (const ClothPattern& pattern : patterns) {
    const SweepLayout layout(pattern);
    const auto colour = [&layout](int point) {
      int c = static_cast<int>(layout.colours.size()) - 1;
      while (layout.slot_of[point] < layout.colours[c].first) --c;
      return c;
    };
    std::set<int> slots(layout.slot_of.begin(), layout.slot_of.end());
    EXPECT_EQ(slots.size(), pattern.points.size());
    for (const Triangle& t : pattern.faces) {
      EXPECT_EQ((std::set<int>{colour(t[0]), colour(t[1]), colour(t[2])}).size(), 3u);
    }
    for (const Spring& s : pattern.springs) EXPECT_NE(colour(s.a), colour(s.b));
  }
}

}  // namespace
}  // namespace softpoint::cloth
