#pragma once

#include <memory>
#include <span>
#include <vector>

#include "player_figure.h"
#include "player_handles.h"
#include "player_rigid.h"
#include "player_world.h"
#include "scene.h"
#include "softpoint/core/deformable_system.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// What one frame cost and did: the profiles of its substeps, added up.
struct FrameWork {
  double step_seconds = 0;   // wall time of stepSimulation, ours and Bullet's
  Profile::Seconds seconds;  // ours, by stage
  long long contacts = 0;    // at the end of the frame
  long long passes = 0, iterations = 0;
  long long pairs = 0, pairs_skipped = 0;             // skipped: shapes that deformables do not meet
  long long without_pairs = 0, without_contacts = 0;  // deformables whose detection, response was skipped
};

// A scene in play: builds the world, then goes on frame by frame. Draws nothing, writes nothing. The same
// scene and precision give the same motion, bit for bit.
class Player {
 public:
  // Throws Error for what can only be found while building (a mesh too large for memory, ...).
  explicit Player(Scene scene);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  // Events that are due, then one frame.
  void step();

  int frame() const { return frame_; }                             // steps taken
  double time() const { return frame_ * scene_.world.time_step; }  // s
  const Scene& scene() const { return scene_; }
  const Overlays& overlays() const { return overlays_; }
  const FrameWork& work() const { return work_; }  // of the last step

  btDiscreteDynamicsWorld& world() { return *world_; }
  const DeformableSystem& system() const { return *system_; }
  const HandleSet& handles() const { return *handles_; }

  std::size_t rigid_count() const { return rigid_.size(); }
  const RigidActor& rigid(std::size_t k) const { return *rigid_[k]; }
  std::size_t deformable_count() const { return deformables_.size(); }
  const Deformable& deformable(std::size_t k) const { return *deformables_[k].body; }
  std::size_t figure_count() const { return figures_.size(); }
  const FigureActor& figure(std::size_t k) const { return *figures_[k]; }
  // Of a body of parts; else null.
  const Articulation* articulation(std::size_t k) const { return deformables_[k].articulation.get(); }
  // Of a cloth; else null.
  const Sheet* sheet(std::size_t k) const { return deformables_[k].sheet.get(); }
  // Is the body in the world now, or switched off?
  bool present(BodyRef body) const;
  // Centre of mass (m); of a plane, its position.
  Vec3 center(BodyRef body) const;

 private:
  void build_rigid_bodies();
  void build_deformables();
  void build_figures();
  void apply(const Event& event);
  void apply(const ImpulseEvent& event);
  void apply(const ToggleEvent& event);
  void put(BodyRef body, bool present);
  Vec3 near_point(const Vec3& near, bool from_body, BodyRef body) const;

  // The last goes first: a character lets go of its exoskeleton.
  struct Actors : std::vector<DeformableActor> {
    Actors() = default;
    Actors(const Actors&) = delete;
    Actors& operator=(const Actors&) = delete;
    ~Actors() {
      while (!empty()) pop_back();
    }
  };

  Scene scene_;
  Overlays overlays_;
  StockWorld world_;
  std::vector<std::unique_ptr<RigidActor>> rigid_;
  std::vector<std::unique_ptr<FigureActor>> figures_;  // leave the world before it goes
  Actors deformables_;
  std::unique_ptr<DeformableSystem> system_;  // after the bodies: leaves the world before they go
  std::unique_ptr<HandleSet> handles_;
  std::vector<char> rigid_present_, deformable_present_;
  std::vector<std::map<std::string, bool>> switch_states_;
  bool gravity_on_ = true;
  std::size_t next_event_ = 0;
  int frame_ = 0;
  FrameWork work_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
