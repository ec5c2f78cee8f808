#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <vector>

#include "softpoint/core/profile.h"
#include "softpoint/core/sleep_settings.h"
#include "softpoint/core/state_archive.h"
#include "softpoint/core/surface.h"
#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI {

class DeformableSystem;
class NearColliders;
struct HeldPoint;

// Base of everything soft. To the Bullet world it is a btSoftBody that serves as mirror and
// collision proxy: the truth is kept here in double precision, and nodes, faces, face tree and
// bounds of the btSoftBody follow it once a step. Never add it with addSoftBody (a stock solver
// would integrate it a second time): use DeformableSystem::add.
//
// Friction and restitution are those of btCollisionObject (setFriction, setRestitution) and combine
// with the collider's as Bullet combines them.
class SOFTPOINT_API Deformable : public btSoftBody, public Surface {
 public:
  ~Deformable() override;
  Deformable(const Deformable&) = delete;
  Deformable& operator=(const Deformable&) = delete;

  std::span<const Vec3> points() const override { return positions_; }
  std::span<const Vec3> velocities() const override { return velocities_; }
  std::span<const Triangle> faces() const override { return triangles_; }
  void apply_impulse(int face, const Vec3& weights, const Vec3& impulse) override;

  std::span<const double> masses() const { return masses_; }      // kg, one per point
  double total_mass() const { return total_mass_; }               // kg
  Vec3 center_of_mass() const;                                    // m
  Vec3 momentum() const;                                          // kg m/s
  Vec3 angular_momentum(const Vec3& about = Vec3::Zero()) const;  // kg m2/s
  double kinetic_energy() const;                                  // J
  virtual double elastic_energy() const = 0;                      // J

  // Extra acceleration of this body alone (m/s2), added to the world's gravity.
  void set_acceleration(const Vec3& acceleration);

  // Sleeping. Bullet puts whole islands to sleep, rigid and deformable bodies alike: a body that has been
  // slower than its threshold for long enough agrees to it. It then costs nothing until Bullet, something
  // that moves near it, a handle, an impulse or a setter wakes it. setActivationState(DISABLE_DEACTIVATION)
  // forbids sleep; DISABLE_SIMULATION freezes the body and takes its contacts away.
  void set_sleep_settings(const SleepSettings& settings);
  const SleepSettings& sleep_settings() const { return sleep_settings_; }  // in force
  bool asleep() const { return asleep_; }  // it took no part in the last substep
  // Also the bodies that sleep with it; Bullet's activate() does the same one substep later.
  void wake();
  double max_speed() const;  // m/s, of the fastest point

  // Unit normals in Bullet's nodes (m_n) and faces (m_normal), which renderers of soft bodies, debug drawing
  // and ray tests of Bullet read; on by default. Where nobody reads them they need not be computed: off, they
  // stay as they were. Back on, they are those of now at once.
  void set_mirrored_normals(bool on);
  bool mirrored_normals() const { return mirrored_normals_; }

  // Times the last-resort guard put this body back to its last finite state.
  long long guard_fired() const { return guard_fired_; }

  // The system this body is attached to, or null.
  DeformableSystem* system() const { return system_; }

  // Bullet's own serializer writes past its struct in double precision; ours refuses to take part.
  int calculateSerializeBufferSize() const override;
  // As a plain collision object, without nodes and faces.
  const char* serialize(void* buffer, btSerializer* serializer) const override;

 protected:
  // `positions` in world coordinates (m), `masses` (kg) > 0 per point.
  Deformable(std::vector<Vec3> positions, std::vector<Triangle> triangles, std::vector<double> masses);

  // The four stages a plugin brings, unless it solves its own contact. None may allocate after the first
  // step, throw or log. By default the points are free particles.
  //
  // 1. Free motion: fill end_positions_ with where the points would be after `dt` seconds without
  //    contact. velocities_ already holds gravity and queued impulses.
  virtual void predict(double dt);
  // 2. Compliance: `blocks`, column-major 3n x 3n with n = touched.size(), receives the velocity change
  //    (m/s) of touched point i per impulse (N s) on touched point j, for the step begun by predict().
  virtual void compliance(std::span<const int> touched, double* blocks);
  // 3. Response: end_positions_ = free_positions_ + dt * (velocity response to these impulses). Their torque
  //    counts at impulse_points_.
  virtual void respond(std::span<const int> touched, std::span<const Vec3> impulses);
  // 4. Commit: take end_positions_ as the new state. The base does x = end, v = (end - x) / dt.
  virtual void commit(double dt);
  // In place of the first three, for a body whose touching points are too many for dense blocks of
  // compliance: it is handed the colliders near it and the points held, and moves by itself. advance_by()
  // fills end_positions_ and the impulses of `held` and gives colliders theirs; velocities_ hold queued
  // impulses but not `acceleration` (m/s2). Meets no other deformables.
  virtual bool solves_contact() const { return false; }
  virtual void advance_by(double dt, const Vec3& acceleration, NearColliders& near,
                          std::span<HeldPoint> held);
  // Outward unit normals of the skin at its points, as smooth as the plugin knows them, at end_positions_:
  // the directions in which corners of colliders press. By default the area-weighted mean of the faces round
  // a point.
  virtual void skin_normals(std::vector<Vec3>& normals) const;
  // Takes a share of an impulse (N s) that acts from the next step on: all of it must be used by then. The
  // base adds it to the point's velocity before predict().
  virtual void queue_impulse(int point, const Vec3& impulse);
  // What kind of body this is, for snapshots: one name a plugin and layout of archive_state().
  virtual std::string_view kind() const { return "deformable"; }
  // The plugin's own members on which the next step depends, for snapshots. Positions and velocities are
  // those of the snapshot already when archive.loading().
  virtual void archive_state(StateArchive& archive);
  // Called when the guard has put positions_ back and zeroed velocities_.
  virtual void restored() {}

  // New masses (kg > 0), one per point; nothing else of the body changes.
  void change_masses(std::span<const double> masses);

  std::vector<Vec3> positions_;       // m, world
  std::vector<Vec3> velocities_;      // m/s
  std::vector<Vec3> end_positions_;   // m, at the end of the step as known so far
  std::vector<Vec3> impulse_points_;  // m, where the torque of impulses is counted; predict() may move them
  std::vector<Vec3> free_positions_;  // m, what predict() left in end_positions_
  std::vector<double> masses_;        // kg, one per point
  std::vector<Triangle> triangles_;   // counter-clockwise seen from outside
  long long refactorizations_ = 0;    // times the plugin made its response anew, for the profile

 private:
  friend class DeformableSystem;
  friend class ContactFinder;
  friend class ContactSolver;
  friend class HandleSolver;
  friend class Skin;

  void begin(double dt, const Vec3& gravity);
  void begin_own(double dt, const Vec3& gravity);
  void take_impulses();
  void finish(double dt);
  void turn_by_couple();
  void mirror(double dt);
  void mirror_normals();
  void fit_face_tree(double padding);
  void archive(StateArchive& archive);
  void fall_asleep();
  bool rested(double dt, bool quiet);
  void build_mirror();

  btSoftBodyWorldInfo world_info_;
  std::unique_ptr<btSoftBodySolver> mirror_solver_;
  std::vector<btDbvtNode*> tree_nodes_;  // inner ones of m_fdbvt, children before parents
  std::vector<Vec3> tree_positions_;     // m, of the points when its boxes were last fitted
  double tree_padding_ = 0;              // m, of the boxes
  std::vector<Vec3> impulses_;           // queued by apply_impulse, N s
  std::vector<std::array<int, 2>> edges_;
  std::vector<std::array<int, 2>> edge_faces_;  // second is -1 on a boundary
  Vec3 acceleration_ = Vec3::Zero();
  Vec3 couple_ = Vec3::Zero();  // N m s, to be added to the torque of the impulses of this step
  double total_mass_ = 0;
  double step_ = 0;  // s, of the step at work
  bool impulses_queued_ = false;
  bool mirrored_normals_ = true;
  long long guard_fired_ = 0;
  SleepSettings sleep_settings_;
  bool asleep_ = false;  // left out of the step
  DeformableSystem* system_ = nullptr;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
