#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

#include "contact_impulses.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Where a figure's bodies touch others in a Bullet world, as its collision detection has found it.
class WorldTouches {
 public:
  // `links[i]`: the link that bodies[i] shows, -1 for one that is left out.
  void gather(btCollisionWorld& world, const std::vector<btRigidBody*>& bodies,
              const std::vector<int>& links);
  bool empty() const { return contacts_.empty(); }

  // `lowest` is where each contact's allowed speed goes; gaps (m) are kept here, negative in penetration.
  std::vector<ContactImpulses::Contact>& contacts() { return contacts_; }
  std::vector<double>& gaps() { return gaps_; }
  // The bodies that give way, as they move now.
  std::span<const ContactImpulses::Other> others();
  // Gives them the opposite of what the figure got.
  void push_back(const std::vector<Vec3>& impulses);

 private:
  int index_of(btRigidBody* body);

  std::vector<ContactImpulses::Contact> contacts_;
  std::vector<double> gaps_;
  std::vector<btRigidBody*> bodies_;
  std::vector<ContactImpulses::Other> others_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
