#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

#include "capsule_distance.h"
#include "contact_impulses.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Where a figure's capsules touch, or could within a time, what is in a Bullet world. Boxes, spheres,
// capsules, planes and compounds of them are looked at in closed form, from where they were so many seconds
// before the end of the world's step: it has moved them already. All else is where its collision detection
// has found it.
class WorldTouches {
 public:
  struct Capsule {
    btRigidBody* body = nullptr;                  // that shows it
    int link = -1;                                // -1: left out
    double radius = 0;                            // m
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  // m, world
    double reach = 0;                             // m, that it can go
  };
  std::vector<Capsule>& capsules() { return capsules_; }

  // What can be met within a step of `dt` s; `own` are left out.
  void gather(btCollisionWorld& world, const std::vector<btRigidBody*>& own, double dt);
  // The contacts within the capsules' reach and what the others can go in `ahead` s, those being `back` s
  // before where they are.
  void look(double back, double ahead);
  long long boxes_overlapping() const { return overlapping_; }  // since construction
  long long narrow_tests() const { return narrow_; }
  bool any_near() const { return !near_.empty() || !found_.empty(); }
  bool empty() const { return contacts_.empty(); }

  // `lowest` is where each contact's allowed speed goes; gaps (m) are kept here, negative in penetration.
  std::vector<ContactImpulses::Contact>& contacts() { return contacts_; }
  std::vector<double>& gaps() { return gaps_; }
  // The bodies that give way, as they move now.
  std::span<const ContactImpulses::Other> others();
  // Gives them the opposite of what the figure got, and the way that this makes up to the step's end.
  void push_back(const std::vector<Vec3>& impulses);

 private:
  struct Near {
    std::size_t capsule;
    const btCollisionObject* object;
  };
  struct Body {
    btRigidBody* body;
    btTransform place;  // when the contacts are looked at,
    double left;        // s from then to where it is
  };
  int index_of(btRigidBody* body, const btTransform& place, double left);
  void look_at(const Near& near, const btCollisionShape& shape, const btTransform& at, double reach);
  void keep(const Capsule& capsule, const SegmentDistance& distance, double inside, double reach);

  std::vector<Capsule> capsules_;
  std::vector<Near> near_;
  std::vector<const btCollisionObject*> candidates_;
  std::vector<ContactImpulses::Contact> found_, contacts_;
  std::vector<double> found_gaps_, gaps_;
  std::vector<btRigidBody*> found_bodies_;
  std::vector<Body> bodies_;
  std::vector<ContactImpulses::Other> others_;
  long long overlapping_ = 0, narrow_ = 0;
  int other_ = -1;        // of what is looked at
  double friction_ = -1;  // of it and the capsule
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
