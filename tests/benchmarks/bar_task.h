#pragma once

#include <Eigen/Geometry>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softpoint/core/vec.h"
#include "support/bar_mesh.h"

// What solvers of elastic bars are compared on: bars of 7 or 13 cylinders in a row along z, the bottom cap
// clamped, the top one moved slowly or pushed. A solver ("contestant") is a name and a function that makes a
// Bar.
namespace softpoint::benchmarks {

inline constexpr double kYoung = 1e5;  // Pa
inline constexpr double kPoisson = 0.3;
inline constexpr double kFrame = 1.0 / 60.0;  // s

// Where the top cap is held, as a rigid plate: its centre's shift from rest, its turn about y after a turn
// about z.
struct EndPose {
  Vec3 shift = Vec3::Zero();  // m
  double turn_y = 0;          // rad
  double turn_z = 0;          // rad
  Mat3 rotation() const {
    return (Eigen::AngleAxisd(turn_y, Vec3::UnitY()) * Eigen::AngleAxisd(turn_z, Vec3::UnitZ()))
        .toRotationMatrix();
  }
};

enum class Motion {
  kStretch,  // by 10 %
  kTwist,    // 90 degrees in 13 cylinders, the same angle a cylinder in fewer
  kBend,     // the same angles, ends turned and brought nearer so that the bar is an arc
  kPush,     // a dead force across the free top cap, by which its centre moves by half the length
};

// For loads of 0 to 1: either where the top cap is held, or a force spread over it.
struct BarTask {
  Motion motion = Motion::kStretch;
  std::string name;
  int parts = 7;
  double amount = 0;  // stretch: m; twist and bend: rad; push: N, along x

  bool is_held() const { return motion != Motion::kPush; }
  double length() const { return parts * reference::kPartLength; }
  EndPose pose(double load) const;
  Vec3 force(double load) const { return Vec3(load * amount, 0.0, 0.0); }
};

// One bar under test. A frame is 1/60 s for solvers that know time.
class Bar {
 public:
  virtual ~Bar() = default;
  virtual void frame(double load) = 0;
  // Of bar_mesh(parts), in its order, m.
  virtual std::vector<Vec3> vertices() const = 0;
  // What holds the top cap, N, and its moment about the cap's centre, N m; where the method knows them.
  virtual std::optional<Vec3> end_force() const { return std::nullopt; }
  virtual std::optional<Vec3> end_moment() const { return std::nullopt; }
  virtual double iterations() const = 0;  // of the last frame, whatever the method counts
  virtual bool has_inertia() const { return false; }
};

struct Contestant {
  std::string method, setting;
  std::function<std::unique_ptr<Bar>(const BarTask&)> make;  // null for a task the method cannot do
};

std::vector<Contestant> assembly_contestants();     // ours; the exact one first
std::vector<Contestant> spring_contestants();       // btSoftBody
std::vector<Contestant> tetrahedra_contestants();   // btDeformable
std::vector<Contestant> collocation_contestants();  // the paper's own method

// The reference: positions of the vertices of bar_mesh, and the force or moment at the end.
struct BarAnswer {
  std::vector<Vec3> vertices;
  double force = 0;  // stretch: N along z; twist: N m about z; bend: N m about y
  Vec3 tip = Vec3::Zero();
};
BarAnswer reference_answer(const BarTask& task);

std::vector<BarTask> all_tasks(int parts);

// Of the free vertices, root mean square, relative to how far the answer has moved them.
double position_error(const BarTask& task, const std::vector<Vec3>& x, const std::vector<Vec3>& answer);
// What the answer's force is compared with; NaN where the method does not know it.
double end_load(const BarTask& task, const Bar& bar);
// Force or moment relative to the answer's; for push the distance of the tip relative to the length.
double end_error(const BarTask& task, const Bar& bar, const BarAnswer& answer);

}  // namespace softpoint::benchmarks
