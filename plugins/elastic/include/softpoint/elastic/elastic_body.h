#pragma once

#include <memory>

#include "softpoint/core/deformable.h"
#include "softpoint/elastic/elastic_model.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A free elastic body: linear elasticity in a frame that turns with it, implicit Euler by one precomputed
// matrix. Stable for any stiffness and time step; momentum and angular momentum are kept to rounding.
class ElasticBody final : public Deformable {
 public:
  // Puts the mesh's origin at `origin` (m), turned by `rotation`, at rest and undeformed.
  explicit ElasticBody(std::shared_ptr<const ElasticModel> model, const Vec3& origin = Vec3::Zero(),
                       const Mat3& rotation = Mat3::Identity());

  // Rigid velocity: `linear` (m/s) of the centre of mass, `angular` (rad/s) about it. Keeps the shape.
  void set_velocity(const Vec3& linear, const Vec3& angular = Vec3::Zero());

  const ElasticModel& model() const { return *model_; }
  // The turning frame that fits the present shape best; columns are its axes in the world.
  Mat3 frame() const;
  // Vertex displacements in that frame (m), 3V doubles, vertex-major.
  void displacements(std::vector<double>& out) const;
  double elastic_energy() const override;  // J

 private:
  void predict(double dt) override;
  void compliance(std::span<const int> touched, double* blocks) override;
  void respond(std::span<const int> touched, std::span<const Vec3> impulses) override;

  void choose_response(double dt);
  void measure_start();
  void add_free_of_net_load(const std::vector<Vec3>& impulses);
  const double* response() const;

  std::shared_ptr<const ElasticModel> model_;
  std::vector<double> own_response_;  // empty while the model's serves
  double own_step_ = 0;               // s, time step of own_response_
  double dt_ = 0;
  Mat3 frame_ = Mat3::Identity();      // R of the step
  Mat3 inertia_inverse_ = Mat3::Zero();  // pseudo-inverse, about the centre of mass at the start of the step
  std::vector<Vec3> arms_;              // m, points from that centre
  std::vector<double> scratch_in_, scratch_out_;  // 3V
  std::vector<Vec3> internal_;          // N s per point
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
