#include "scene_figure_file.h"

#include <Eigen/Geometry>
#include <filesystem>
#include <numbers>

#include "scene_limits.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/bvh.h"
#include "softpoint/figure/urdf.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr double kLeastScale = 1e-6, kMostScale = 1e6;

struct FigureFile {
  std::filesystem::path path;
  figure::UrdfBase base;
  figure::BvhFigureSettings skeleton;
  bool upright;  // its y axis points up the scene's z
  Vec3 position;
};

// Files of motion are given in axes of their own: where the first link is, seen from the scene.
void place_motion(const FigureFile& file, figure::JointTrack& root) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(file.upright ? std::numbers::pi / 2 : 0, Vec3::UnitX()));
  for (figure::JointKey& key : root.keys) {
    const Vec3 at = turn * Vec3(key.q[0], key.q[1], key.q[2]) + file.position;
    const Eigen::Quaterniond q = turn * Eigen::Quaterniond(key.q[3], key.q[4], key.q[5], key.q[6]);
    key.q = {at.x(), at.y(), at.z(), q.w(), q.x(), q.y(), q.z()};
  }
}

FigureFromFile load(const FigureFile& file) {
  const std::string extension = file.path.extension();
  FigureFromFile result;
  if (extension == ".bvh") {
    const figure::BvhClip clip = figure::read_bvh_file(file.path);
    result.model = std::make_shared<const figure::FigureModel>(figure::bvh_figure(clip, file.skeleton));
    result.capsules = figure::bvh_capsules(clip, file.skeleton);
    if (clip.frame_count() > 0) {
      result.tracks = figure::bvh_tracks(clip, figure::Interpolation::kCubic, file.skeleton);
      place_motion(file, result.tracks[0]);
    }
  } else if (extension == ".urdf") {
    result.model = std::make_shared<const figure::FigureModel>(
        figure::read_urdf_file(file.path, file.base, &result.capsules));
  } else {
    result.model = std::make_shared<const figure::FigureModel>(figure::read_amdl_file(file.path));
  }
  return result;
}

}  // namespace

FigureFromFile read_figure_file(ObjectReader& item) {
  FigureFromFile result;
  item.optional_object("model", "a figure from a file, in place of `links`", [&](ObjectReader& object) {
    FigureFile file;
    file.path = object.file("file", {.doc = ".bvh: skeleton and motion; .urdf: a robot, joints named like "
                                            "their links; else the text format of `softpoint figure`, "
                                            "without shapes"});
    file.base = object.choice<figure::UrdfBase>(
        "base",
        {{"auto", figure::UrdfBase::kAuto},
         {"free", figure::UrdfBase::kFree},
         {"fixed", figure::UrdfBase::kFixed}},
        {.fallback = "auto", .doc = "of a .urdf: how its root stands; auto: free if it has a mass"});
    file.skeleton.scale = object.number(
        "scale", {.low = kLeastScale, .high = kMostScale, .fallback = 1, .doc = "of a .bvh: m a unit"});
    file.skeleton.density = object.number(
        "density", {.low = 1e-3, .high = 1e6, .fallback = 1000, .doc = "of a .bvh: kg/m3 of its bones"});
    file.skeleton.thickness = object.number(
        "thickness",
        {.low = 1e-3, .high = 10, .fallback = 0.1, .doc = "of a .bvh: radius of a bone over its length"});
    file.upright = object.choice<bool>("up", {{"y", false}, {"z", true}},
                                       {.fallback = "y", .doc = "of a .bvh: the scene's axis that its y is"});
    file.position = object.vec3("position", {.quantity = Quantity::kLength,
                                             .low = -kMaxLength,
                                             .high = kMaxLength,
                                             .fallback = Vec3::Zero(),
                                             .doc = "of a .bvh: where its origin is in the scene"});
    if (object.describing()) return;
    try {
      result = load(file);
    } catch (const Error& error) {
      object.refuse("file", error.what());
    }
  });
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
