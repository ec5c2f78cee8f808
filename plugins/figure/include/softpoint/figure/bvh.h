#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "softpoint/figure/figure_collision.h"
#include "softpoint/figure/keyframes.h"

// Skeletons and motion in Biovision's text format: what capture systems write and animation programs import.
namespace softpoint::inline SOFTPOINT_ABI::figure {

enum class BvhChannel { kXPosition, kYPosition, kZPosition, kXRotation, kYRotation, kZRotation };
// "Xposition" to "Zrotation".
SOFTPOINT_API const char* name(BvhChannel channel);

struct BvhJoint {
  std::string name;
  int parent = -1;             // index of an earlier joint; -1 for the root, which comes first
  Vec3 offset = Vec3::Zero();  // from the parent's joint, in its axes; units of the file
  std::vector<BvhChannel> channels;
  std::vector<Vec3> end_sites;  // where it ends if no joint says so, in its axes
};

// A motion: rows of channels, a row a frame; the channels of all joints in their order. Lengths in units of
// the file, angles in degrees.
struct SOFTPOINT_API BvhClip {
  std::vector<BvhJoint> joints;
  double frame_time = 1.0 / 30;  // s
  std::vector<double> values;

  int channel_count() const;
  int frame_count() const;
};

// Throws Error naming file and line for whatever is not of the format, numbers that are not finite or beyond
// 1e9, more than 10,000 joints, more than 256 in a row, a frame time not in 1e-6 to 1000 s.
SOFTPOINT_API BvhClip read_bvh(std::istream& in, const std::string& name);
SOFTPOINT_API BvhClip read_bvh_file(const std::string& path);
// Every number reads back as the same double. Throws Error unless each joint is followed by all that hangs on
// it.
SOFTPOINT_API std::string bvh_text(const BvhClip& clip);

// What a skeleton says nothing about.
struct BvhFigureSettings {
  double scale = 1;        // m a unit of the file
  double density = 1000;   // kg/m3
  double thickness = 0.1;  // radius of a bone over its length
};
// A figure of the skeleton: the root free, every other joint a ball; a solid cylinder to each child and end
// site, a ball as thick as the bones that meet there where there is none. Position channels of the root stand
// for its offset, those of others count for nothing.
SOFTPOINT_API FigureModel bvh_figure(const BvhClip& clip, const BvhFigureSettings& settings = {});
// Its positions at a frame, for the `q` of bvh_figure().
SOFTPOINT_API std::vector<double> bvh_positions(const BvhClip& clip, int frame,
                                                const BvhFigureSettings& settings = {});
// Its bones as shapes to touch and to draw.
SOFTPOINT_API std::vector<LinkCapsule> bvh_capsules(const BvhClip& clip,
                                                    const BvhFigureSettings& settings = {});
// The clip's motion as keys of bvh_figure(), the first frame at 0 s: one track a joint. Throws Error where
// the clip has no frame.
SOFTPOINT_API std::vector<JointTrack> bvh_tracks(const BvhClip& clip, Interpolation interpolation,
                                                 const BvhFigureSettings& settings = {});

// Any figure's motion as a clip, frame by frame: joints of three rotations (Z, X, Y), positions for the root
// and for sliding joints; one unit of the file is a metre. Links that stand on the world each are joined by a
// root called "world".
class SOFTPOINT_API BvhRecorder {
 public:
  BvhRecorder(const FigureModel& model, double frame_time);
  void add(const double* q);  // angles go on from the frame before without jumps
  const BvhClip& clip() const { return clip_; }
  // The clip's joint of a link: joints stand in the file's order, each followed by all that hangs on it.
  int joint_of(int link) const;

 private:
  FigureModel model_;
  bool has_world_ = false;
  std::vector<int> order_;  // links as the joints stand
  BvhClip clip_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
