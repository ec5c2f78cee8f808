#pragma once

#include <BulletDynamics/Dynamics/btActionInterface.h>

#include <deque>

#include "contact_finder.h"
#include "contact_solver.h"
#include "mesh_patches.h"
#include "near_colliders_impl.h"
#include "pair_algorithm.h"
#include "softpoint/core/deformable_system.h"
#include "solver_tap.h"

namespace softpoint::inline SOFTPOINT_ABI {

// One substep, as Bullet calls it: pair_found for every near pair during collision detection, all_solved
// before Bullet integrates positions, updateAction after.
struct __attribute__((visibility("hidden"))) DeformableSystem::Impl final : PairListener,
                                                                            SolvedListener,
                                                                            btActionInterface {
  Impl(btDiscreteDynamicsWorld& world, const ContactSettings& settings);
  ~Impl() override;

  bool owns(const btCollisionObject* object) const override;
  void pair_found(const btCollisionObject* deformable, const btCollisionObject* other, double dt) override;
  void pair_gone(const btCollisionObject* deformable, const btCollisionObject* other) override;
  void before_solving() override;
  void all_solved(double dt) override;
  void updateAction(btCollisionWorld* world, btScalar dt) override;
  void debugDraw(btIDebugDraw* drawer) override;

  // Index of a body of this system, or -1.
  int index_of(const btCollisionObject* object) const;
  Handle& handle(HandleId id, const char* caller);
  Handle new_handle(const char* caller, const char* target_name, const Deformable& body, int point,
                    const Vec3& target, double max_force);
  void add_handle(Deformable& body, const Handle& handle);
  bool in_world(const btCollisionObject* object, int& index) const;
  void let_go(const Handle& held);
  void forget(const Deformable& body);
  void wake_mates(const Deformable& body);
  // Snapshots (snapshot_system.cpp, snapshot_world.cpp).
  void archive(StateArchive& archive, SnapshotScope& scope);
  void taken_over();
  void drop_vanished();
  void check_between_steps(const char* caller) const;
  void flush_contact_caches();
  void forbid_collisions(bool forbid);
  void forget_meshes();
  void release_lost_anchors();
  double last_step() const { return last_dt_; }  // s

  btDiscreteDynamicsWorld& world;
  ContactSettings settings;
  std::vector<Deformable*> bodies;
  std::vector<Handle> handles;
  std::vector<Handle> resting_handles_;  // of sleeping bodies
  HandleId next_handle = 1;
  std::vector<ContactPoint> contact_points;
  Profile profile;

 private:
  struct PlacedShape {
    int body;
    ShapeInstance instance;
  };
  struct SkinPair {  // two deformables that are near each other, and their place-holders among rigid_
    int first, second;
    int first_rigid, second_rigid;
    bool joins(int a, int b) const { return (a == first && b == second) || (a == second && b == first); }
    int rigid_of(int body) const { return body == first ? first_rigid : second_rigid; }
  };
  struct OwnLoad {  // what a body that solves its own contact did to a collider in the last substep
    int body = 0;
    const btCollisionObject* object = nullptr;
    Wrench wrench;  // on the collider
    double dt = 0;  // s, of the substep over which it acted
    int object_index = 0;
  };
  struct Surrounding {  // a static or kinematic object near a sleeping body, and where it was
    const Deformable* body = nullptr;
    const btCollisionObject* object = nullptr;
    btTransform pose = btTransform::getIdentity();
  };
  struct Pair {
    int body;
    const btCollisionObject* other;
    bool ahead;  // found by add_pairs_ahead, not by the broadphase
  };
  // The stages of a substep, in order.
  // Pairs begin anew, colliders feel the contact forces of the last substep; `solved`: Bullet has solved
  // already.
  void open_substep(double dt, bool solved);
  void predict(double dt);          // free motion
  void place_colliders(double dt);  // poses, velocities and shapes of what is near
  void solve_contacts(double dt);   // detect and solve until the end of the step is free of penetration
  void advance_own(double dt);      // bodies that solve their own contact
  void keep_contacts(double dt);    // readable contact forces, warm start of the next substep
  void commit(double dt);           // new positions, guard, mirror

  // Sleeping and waking (sleeping.cpp).
  void wake_the_roused(double dt);  // those that the app, Bullet or their surroundings have roused
  void freeze_the_disabled();       // those of DISABLE_SIMULATION
  void put_to_sleep();              // those that Bullet put to sleep
  void rouse(Deformable& body, double dt);
  void rouse_mate(btCollisionObject& mate, double dt);
  void rejoin(Deformable& body, double dt);
  void part(Deformable& body);
  void add_near_pairs(const Deformable& body);
  void wake_by_meeting(int body, const btCollisionObject& other, double dt);
  void lose_surrounding(const btCollisionObject* deformable, const btCollisionObject* other);
  void add_pair(int body, const btCollisionObject* other);
  bool surroundings_moved(const Deformable& body) const;
  bool is_quiet(const Deformable& body) const;
  void settle_rest(double dt);  // who agrees to sleep
  bool ties_agree(const Deformable& body, double dt) const;
  bool tied_to_awake(const Deformable& body) const;
  void collect_islands(const Deformable& body);
  bool in_islands(const btCollisionObject& object) const;
  void rouse_mates(const Deformable& body, double dt);

  void archive_object(StateArchive& archive, const btCollisionObject*& object);
  void archive_handle(StateArchive& archive, Handle& held);
  void archive_contact(StateArchive& archive, Contact& contact);
  void archive_contact_point(StateArchive& archive, ContactPoint& point);
  void archive_surrounding(StateArchive& archive, Surrounding& near);
  void archive_world(StateArchive& archive);
  int place_of(const btCollisionObject* object) const;
  void watch_pairs();
  void drop_unpaired();
  bool apart(const btCollisionObject* body, const btCollisionObject* object) const;

  void carry_load(Contact& contact, double scale, double dt);
  void carry_load(Handle& held, double scale, double dt);
  // Bodies that solve their own contact (own_contact.cpp).
  void carry_own_loads(double dt);
  void carry_own_load(OwnLoad& load, double dt);
  void see_colliders(int body, double dt);
  void hold_points(int body, double dt);
  std::span<signed char> sides_of_mesh(int body, const btCollisionObject* object, int child);
  void keep_own_load(int body, double dt);
  void archive_own_loads(StateArchive& archive, int body);
  void forget_impulses(int body);
  void add_pairs_ahead();
  const ColliderShape& mesh_patch(int body, int rigid, const btConcaveShape& shape, const Pose& local,
                                  int child);
  void add_shape(int body, int rigid, const btCollisionShape& shape, const Pose& local, int& child);
  double detect(bool first);
  void detect_on_shape(const PlacedShape& placed);
  void detect_between(const SkinPair& pair, int index);
  bool refresh(Contact& contact);
  Vec3 other_point(const Contact& contact) const;  // m, where the other is at the end of the step
  void prepare_contacts(double dt);
  Vec3 gravity_on(const Deformable& body) const;  // m/s2

  SolverTap tap_;
  PairHook pairs_hook_;
  std::vector<Pair> pairs_;
  RigidStates rigid_{world};
  ColliderShapes shapes_;
  MeshPatches patches_;
  std::vector<PlacedShape> placed_;
  std::vector<PlacedShape> own_placed_;  // near bodies that solve their own contact
  std::vector<OwnLoad> own_loads_;
  NearColliders near_{std::make_unique<NearColliders::Impl>()};
  std::vector<HeldPoint> held_;
  struct MeshSides {
    const Deformable* body = nullptr;
    const btCollisionObject* object = nullptr;
    int child = 0;
    long long substep = 0;  // of the last use
    std::vector<signed char> of_points;
  };
  std::deque<MeshSides> mesh_sides_;
  std::vector<NearColliders::Impl::LastVelocity> last_velocities_;
  std::vector<SkinPair> skin_pairs_;
  std::vector<Bounds> step_bounds_;     // of each body from start to free end, with some margin
  std::vector<ContactFinder> finders_;  // one per body: each keeps bounds of its faces
  ContactTable contacts_;
  // What sleeping bodies were left with, for the first step after waking.
  struct RestingContact {
    Contact contact;
    double dt = 0;  // s, of the substep over which its impulse acted
  };
  std::vector<RestingContact> resting_contacts_;
  std::vector<Surrounding> surroundings_;
  std::vector<int> islands_;  // of one body and what it is tied to
  btVector3 known_gravity_;
  ContactSolver solver_;
  SupportContacts support_;
  double dt_ = 0;  // s, of the substep at work
  double last_dt_ = 0;
  bool restored_ = false;  // since the last step
  bool flushing_ = false;
  bool open_ = false;
  bool solved_ = false;
  bool bullet_solved_ = false;       // in this substep, Bullet has solved the rigid bodies
  bool pairs_added_ = false;         // in this substep, by add_near_pairs
  const bool gravity_each_substep_;  // and as a change of velocity; other worlds: a force, once a step
};

}  // namespace softpoint::inline SOFTPOINT_ABI
