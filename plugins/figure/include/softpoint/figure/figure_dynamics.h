#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Moment (N m) about, and force (N) at, the origin of a link's frame; world axes.
struct Wrench {
  int link = 0;
  Vec3 moment = Vec3::Zero();
  Vec3 force = Vec3::Zero();
};

// Where a link is and how it moves; the point is the origin of its frame, all in world axes.
struct LinkMotion {
  Vec3 position = Vec3::Zero();          // m
  Mat3 orientation = Mat3::Identity();   // the link's axes in the world's
  Vec3 angular_velocity = Vec3::Zero();  // rad/s
  Vec3 velocity = Vec3::Zero();          // m/s
};

// What a figure has at one instant.
struct FigureMechanics {
  double kinetic_energy = 0;             // J, that of armatures included
  double potential_energy = 0;           // J, zero at the world's origin
  Vec3 momentum = Vec3::Zero();          // kg m/s
  Vec3 angular_momentum = Vec3::Zero();  // kg m2/s, about the world's origin
  Vec3 center_of_mass = Vec3::Zero();    // m
};

// How accelerations are found.
enum class ForwardMethod {
  kArticulated,  // articulated bodies, O(N)
  kMatrix,       // the paper's way, slow and plain: B by (3), H by (4) column by column, elimination; O(N^3)
};

// Forces and accelerations of one figure, in O(N): each joint is either dynamic (its force is known, its
// acceleration wanted) or prescribed (the other way round). Keeps its storage; calls allocate nothing.
//
// Arrays are laid out as FigureModel says. Numbers of balls and free joints in `qd`, `qdd` and `tau` go by
// the axes that their velocities have.
class SOFTPOINT_API FigureDynamics {
 public:
  explicit FigureDynamics(const FigureModel& model);
  ~FigureDynamics();
  FigureDynamics(FigureDynamics&&) noexcept;
  FigureDynamics& operator=(FigureDynamics&&) noexcept;

  const FigureModel& model() const;

  // Which links' joints are dynamic; all are to begin with. Prescribed joints cut the figure into pieces:
  // what has no dynamic joint between itself and the world is only moved along, and what leads to none at all
  // is left out.
  void set_dynamic(std::span<const bool> links);
  void set_all_dynamic(bool dynamic);
  bool dynamic(int link) const;

  void set_method(ForwardMethod method);  // kArticulated to begin with
  ForwardMethod method() const;

  void set_gravity(const Vec3& gravity);  // m/s2
  const Vec3& gravity() const;
  // Acceleration (m/s2) of the world the figure stands in, added to all: `a` of (1) is this less gravity.
  void set_base_acceleration(const Vec3& acceleration);
  const Vec3& base_acceleration() const;
  // This time (s; 0 to begin with) times a joint's viscous friction counts as inertia of the joint in
  // forward(): what makes a step of so much implicit in it.
  void set_implicit_time(double time);

  // Accelerations of the dynamic joints for `tau` (null: zero torque) less the joints' viscous friction, and
  // for `loads`. Entries of prescribed joints in `qdd` are read, the others written.
  void forward(const double* q, const double* qd, const double* tau, double* qdd,
               std::span<const Wrench> loads = {});
  // After forward(): what the accelerations of the dynamic joints gain from `loads` alone, everything else
  // unchanged.
  void respond(std::span<const Wrench> loads, double* change);
  // The same for torques (N m, N) in the dynamic joints: H^-1 tau.
  void respond_to_torques(const double* tau, double* change);
  // Torques (N m, N) of all joints that give the accelerations `qdd`: (1). Friction and armature included.
  void inverse(const double* q, const double* qd, const double* qdd, double* tau,
               std::span<const Wrench> loads = {});

  // The paper's own way, slow and plain: bias vector by (3), inertia matrix by (4), column by column (n x n,
  // column-major). Every joint counts, dynamic or not.
  void bias(const double* q, const double* qd, double* b, std::span<const Wrench> loads = {});
  void inertia_matrix(const double* q, double* h);

  // Pose and motion of links, and sums over the figure, in the state that place() was given.
  void place(const double* q, const double* qd);
  LinkMotion motion(int link) const;
  FigureMechanics mechanics() const;

  // Bodies whose inertia was assembled, and bodies placed, since construction: what the figure did not need
  // is not among them.
  struct Counts {
    long long calls = 0, placed = 0, articulated = 0;
  };
  const Counts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
