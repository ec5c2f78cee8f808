#pragma once

#include <cstdint>
#include <vector>

#include "collider_shape.h"
#include "rigid_state.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Which features touch: a vertex of the skin anywhere on the shape, a corner of the shape anywhere on the
// skin, two edges, or a face of the skin on a round shape. With body, object, child and feature indices it
// names a contact over passes and steps.
enum class ContactKind : std::int8_t { vertex, corner, edge, face };

// One contact between a deformable (as up to three weighted points) and a feature of a rigid shape or of
// another deformable.
struct Contact {
  // Identity.
  int body = 0;  // index into the system's bodies
  const btCollisionObject* object = nullptr;
  int child = 0;  // of a compound, counted over all levels
  ContactKind kind = ContactKind::vertex;
  int rigid_feature = -1;  // corner or edge of the shape
  int skin_feature = -1;   // vertex, edge or face of the deformable; a corner slides over faces

  // Geometry at the last detection, end-of-step configuration.
  int rigid = -1;  // index into RigidStates; of another deformable, that of a still place-holder
  int count = 0;
  std::array<int, 3> points{};
  std::array<double, 3> weights{};
  int other_body = -1;  // index of the other deformable; -1 where the other is rigid
  int other_count = 0;  // its weighted points, likewise
  std::array<int, 3> other_points{};
  std::array<double, 3> other_weights{};
  Vec3 normal = Vec3::UnitY();      // from the collider towards the deformable
  double gap = 0;                   // m beyond the margin; negative needs a push
  Vec3 rigid_point = Vec3::Zero();  // m, on the collider's surface, in its frame
  Vec3 arm = Vec3::Zero();  // m, contact point at the start of the step from the collider's centre of mass
  int shape_index = -1;     // of the placed shape, this substep
  bool seen = false;        // active in this pass
  bool met = false;         // found by some detection of this substep

  double friction = 0;
  bool fresh = true;  // met for the first time in this substep
  double restitution = 0;
  double approach = 0;    // m/s, speed of the impact that a rebound still has to answer
  double fall_speed = 0;  // m/s, what gravity adds to the approach in one step
  bool faded = false;     // half the impulse is to be kept
  bool unpaired = false;  // with an object that is no pair of the broadphase
  double rebound = 0;     // m/s, separation speed asked for in this step

  Vec3 impulse = Vec3::Zero();  // N s on the deformable over the substep
};

// A collision shape placed on an object, as one detection sees it.
struct ShapeInstance {
  int index = -1;  // among the placed shapes
  int rigid = -1;
  int child = 0;
  const ColliderShape* collider = nullptr;
  Pose local;  // of the shape on its object
};

// Contacts with lookup by identity. Keeps its storage from step to step.
class ContactTable {
 public:
  void clear();
  // The contact with this identity, made (with zero impulse) when new.
  Contact& find_or_add(const Contact& identity);
  Contact* find(const Contact& identity);
  // Drops contacts for which `drop` is true, keeping the order of the rest.
  template <class Predicate>
  void erase_if(Predicate drop) {
    std::erase_if(contacts_, drop);
    rebuild();
  }

  // After changes of identities.
  void reindex() { rebuild(); }

  std::vector<Contact>& all() { return contacts_; }
  const std::vector<Contact>& all() const { return contacts_; }

 private:
  void rebuild();
  std::size_t slot(const Contact& identity) const;

  std::vector<Contact> contacts_;
  std::vector<int> slots_;  // open addressing, -1 is free; size a power of two
};

}  // namespace softpoint::inline SOFTPOINT_ABI
