#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softpoint/core/deformable.h"
#include "softpoint/elastic/elastic_model.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Largest component of a force on a point, N.
inline constexpr double kMaxPointForce = 1e18;
// Largest entry of the stiffness of point loads, N/m.
inline constexpr double kMaxPointStiffness = 1e15;

class PointLoads;

// A free elastic body: linear elasticity in a frame that turns with it, implicit Euler by one precomputed
// matrix. Stable for any stiffness and time step; momentum and angular momentum are kept to rounding.
class SOFTPOINT_API ElasticBody final : public Deformable {
 public:
  // Puts the mesh's origin at `origin` (m), turned by `rotation`, at rest and undeformed. Throws Error for no
  // model, what is no rotation, or points farther out than kMaxPosition.
  explicit ElasticBody(std::shared_ptr<const ElasticModel> model, const Vec3& origin = Vec3::Zero(),
                       const Mat3& rotation = Mat3::Identity());

  ~ElasticBody() override;

  // Rigid velocity: `linear` (m/s) of the centre of mass, `angular` (rad/s) about it. Keeps the shape. Throws
  // Error beyond kMaxSpeed or kMaxSpin.
  void set_velocity(const Vec3& linear, const Vec3& angular = Vec3::Zero());

  // Loads from the next step on, until set anew or cleared: `forces` (N, world) on `points` (vertices of the
  // mesh) at the start of the step, and how they change while the step moves the points: `stiffness`, column-
  // major 3n x 3n, symmetric and positive semidefinite, world (N/m), or empty for none. The force at the end
  // is Q F - Q P K P Q^T (x_end - x_rigid), with Q the turn of the body over the step, x_rigid the points
  // carried along by it, P what takes away the best-fit rigid motion of the points: springs between the
  // points neither brake a flight nor turn it. The stiffness makes the step stable however stiff it is, as
  // long as the true one is less than twice as stiff; of forces that depend on how the body as a whole lies,
  // no account is taken within the step. Their owner sets them before each substep (from a pre-tick callback,
  // say); snapshots do not hold them. Allocates nothing where there were as many points before. A change
  // beyond rounding wakes a sleeping body. Throws Error, nothing changed, for indices, numbers or a stiffness
  // out of range.
  void set_point_loads(std::span<const int> points, std::span<const Vec3> forces,
                       std::span<const double> stiffness = {});
  void clear_point_loads();
  // Forces of the loads at the end of the last step (N, world), one per point; zero before the first step.
  std::span<const Vec3> point_load_forces() const;

  // Shared with other bodies.
  const ElasticModel& model() const { return *model_; }
  // The turning frame that fits the present shape best; columns are its axes in the world.
  Mat3 frame() const;
  // Vertex displacements in that frame (m), 3V doubles, vertex-major.
  void displacements(std::vector<double>& out) const;
  double elastic_energy() const override;  // J

 private:
  friend class Character;
  void predict(double dt) override;
  void compliance(std::span<const int> touched, double* blocks) override;
  void respond(std::span<const int> touched, std::span<const Vec3> impulses) override;
  void commit(double dt) override;
  void skin_normals(std::vector<Vec3>& normals) const override;
  std::string_view kind() const override { return "elastic"; }
  void archive_state(StateArchive& archive) override;
  void restored() override;

  // Loads on points: elastic_body_loads.cpp.
  bool loaded() const;
  bool has_springs() const;
  void carry_loads();
  Mat3 shape_response(int i, int j) const;
  void add_shape_response(const double* impulses);
  double work_of_loads() const;
  void note_load_forces();
  void stiffen(std::span<const int> touched, double* blocks);
  void react(std::span<const int> touched, std::span<const Vec3> impulses);

  // The stages of predict().
  void choose_response(double dt);
  void split_motion();
  void predict_positions();
  void relax_shape();
  void multiply_response();
  void settle_free_motion();

  double strain_energy_of(const std::vector<Vec3>& arms) const;
  void correct_turn(Mat3& turn, const Mat3& inverse, double wanted) const;
  Vec3 give_up_energy(const Vec3& center, const Mat3& inverse, double rigid, double internal);
  const double* response() const;
  Mat3 inverse_inertia(const std::vector<Vec3>& arms) const;

  std::shared_ptr<const ElasticModel> model_;
  std::vector<double> own_response_;          // empty while the model's serves
  double own_step_ = 0;                       // s, time step of own_response_
  bool own_is_due_ = false;                   // own_response_ is still to be made for own_step_
  double strain_energy_ = 0;                  // J, of the last committed shape
  std::unique_ptr<PointLoads> loads_;         // null as long as none were set
  Mat3 rest_inverse_inertia_ = Mat3::Zero();  // of the rest shape, for loads

  // The step at work. Arms and spin are about the centre of mass; strain and forces in the frame R.
  double dt_ = 0;
  Mat3 frame_ = Mat3::Identity();  // R
  Mat3 turn_ = Mat3::Identity();   // Q, rigid turn over the step
  Mat3 inverse_inertia_ = Mat3::Zero();
  Vec3 start_center_ = Vec3::Zero();
  Vec3 center_velocity_ = Vec3::Zero();
  Vec3 spin_ = Vec3::Zero();  // L, kg m2/s
  double energy_at_start_ = 0;
  Mat3 start_frame_ = Mat3::Identity();  // frame, strain and force before the step
  double start_strain_energy_ = 0;
  std::vector<Vec3> start_strain_, start_force_;
  std::vector<Vec3> arms_;                        // r
  std::vector<Vec3> end_arms_;                    // r'
  std::vector<Vec3> shape_velocity_;              // w
  std::vector<Vec3> inertial_;                    // apparent accelerations in the turning frame, m/s2
  std::vector<Vec3> strain_;                      // d + delta
  std::vector<Vec3> force_;                       // S (d + delta), N
  std::vector<Vec3> free_velocities_;             // at the end of the step, without impulses
  std::vector<double> scratch_in_, scratch_out_;  // 3V
  std::vector<float> single_in_, single_out_;     // 3V and padding, with a model in single precision

  // With impulses from outside.
  bool pushed_ = false;
  Vec3 pushed_spin_ = Vec3::Zero();
  Vec3 pushed_momentum_ = Vec3::Zero();
  double strain_energy_pushed_ = 0;
  std::vector<Vec3> response_velocity_;
  std::vector<Vec3> pushed_force_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
