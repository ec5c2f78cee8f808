#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A share of a body's skin that has a colour of its own.
struct Piece {
  std::vector<Triangle> faces;  // between the body's points
  std::optional<Vec3> color;    // 0 to 1, sRGB-encoded; absent: the body's
  bool lighter = false;         // to tell it from its neighbours
};

// What a body of parts measures now.
struct ArticulationState {
  struct Part {
    double length = 0;  // m, of its bone
    double bend = 0;    // rad, between the directions of its two ends
  };
  struct End {
    std::string name;
    Vec3 force = Vec3::Zero();  // N, of what holds it
  };
  double gap = 0;     // m, largest distance of paired vertices at joining surfaces
  double kink = 0;    // rad, largest angle across the rim of a joining surface, over that at rest
  double volume = 0;  // m3
  std::vector<Part> parts;
  std::vector<End> held;
  int iterations = 0;       // of the last solve
  double residual = 0;      // of its joints
  bool balanced = true;     // within the tolerance
  int segments_solved = 0;  // whose skin was computed
};

// What a body of parts brings beside its skin: ends that may be held and led, pieces to colour, numbers. Ends
// are counted part by part, root before tip.
class Articulation {
 public:
  Articulation() = default;
  Articulation(const Articulation&) = delete;
  Articulation& operator=(const Articulation&) = delete;
  virtual ~Articulation() = default;

  // Holds an end where it is: all of its surface, or the end of its bone alone.
  virtual void hold(int end, bool surface) = 0;
  virtual void release(int end) = 0;
  // Of the end of the bone (m), and the turn of its surface from the rest pose: axis times angle (rad).
  virtual Vec3 position(int end) const = 0;
  virtual Vec3 turn(int end) const = 0;
  // Where a held end is to be; without a turn it keeps its own.
  virtual void move(int end, const Vec3& position, const std::optional<Vec3>& turn) = 0;
  // N, of its holder.
  virtual Vec3 force(int end) const = 0;

  virtual const std::vector<Piece>& pieces() const = 0;
  virtual int visible_points() const = 0;
  virtual int visible_faces() const = 0;
  virtual int segments() const = 0;
  virtual ArticulationState measure() const = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
