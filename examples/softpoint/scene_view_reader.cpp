#include "scene_view_reader.h"

#include <Eigen/Geometry>

#include <numbers>

#include "scene_body_ref.h"
#include "scene_limits.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

void read_camera_keyframes(ObjectReader& item, CameraSpec& camera) {
  std::vector<Keyframe> eyes, targets;
  const Timing timing =
      item.choice<Timing>("timing", {{"smooth", Timing::kSmooth}, {"linear", Timing::kLinear}},
                          {.fallback = "smooth", .doc = "of keyframes"});
  item.list(
      "keyframes", {.min = 1, .optional = true, .doc = "instead of eye and target"},
      [&](ObjectReader& key, int) {
        const double time = key.number("time", {.quantity = Quantity::kTime, .low = 0.0, .high = kMaxTime});
        if (!eyes.empty() && time <= eyes.back().time) {
          key.refuse("time", "permitted are times in rising order");
        }
        eyes.push_back(
            {time, key.vec3("eye", {.quantity = Quantity::kLength, .low = -kMaxPlace, .high = kMaxPlace})});
        targets.push_back(
            {time,
             key.vec3("target", {.quantity = Quantity::kLength, .low = -kMaxPlace, .high = kMaxPlace})});
        if (!key.describing() && (eyes.back().value - targets.back().value).norm() < 1e-6) {
          key.refuse("eye", "it stands at the target; permitted is any other place");
        }
      });
  if (!eyes.empty() && !item.describing()) {
    camera.eye_path = Path(std::move(eyes), timing);
    camera.target_path = Path(std::move(targets), timing);
  }
}

void read_camera(ObjectReader& item, const Scene& scene, CameraSpec& camera) {
  camera.eye = item.vec3("eye", {.quantity = Quantity::kLength,
                                 .low = -kMaxPlace,
                                 .high = kMaxPlace,
                                 .fallback = camera.eye,
                                 .doc = "where it stands"});
  camera.target = item.vec3("target", {.quantity = Quantity::kLength,
                                       .low = -kMaxPlace,
                                       .high = kMaxPlace,
                                       .fallback = camera.target,
                                       .doc = "what it looks at"});
  camera.up = item.vec3("up", {.low = -kMaxDirection,
                               .high = kMaxDirection,
                               .fallback = camera.up,
                               .doc = "the world's up, any length but 0"});
  camera.fov = item.number("fov", {.quantity = Quantity::kAngle,
                                   .low = 1.0 * kDegree,
                                   .high = 150.0 * kDegree,
                                   .fallback = camera.fov,
                                   .doc = "vertical field of view"});
  camera.follow = read_optional_body_ref(item, "follow", scene, "name of a body to move along with");
  read_camera_keyframes(item, camera);
  if (item.describing()) {
    return;
  }
  const Vec3 sight = camera.target - camera.eye;
  if (sight.norm() < 1e-6) {
    item.refuse("eye", "it stands at the target; permitted is any other place");
  }
  if (camera.up.cross(sight).norm() < 1e-6 * camera.up.norm() * sight.norm() || camera.up.norm() < 1e-9) {
    item.refuse("up", "permitted is any direction that is not the line of sight");
  }
}

void read_overlays(ObjectReader& item, PictureSpec& pictures) {
  pictures.overlays.contacts =
      item.boolean("contacts", {.fallback = false, .doc = "points of contact with deformables"});
  pictures.overlays.forces = item.boolean(
      "forces", {.fallback = false, .doc = "arrows: contact forces on deformables, pulls of handles"});
  pictures.meters_per_newton =
      item.number("meters_per_newton",
                  {.low = 0.0, .high = 1e3, .above = true, .fallback = 0.002, .doc = "length of the arrows"});
  pictures.overlays.wireframe = item.boolean("wireframe", {.fallback = false, .doc = "edges of deformables"});
  pictures.overlays.time = item.boolean("time", {.fallback = true, .doc = "the time in a corner"});
  pictures.text = item.text("text", {.fallback = "", .doc = "a line in the same corner"});
}

void read_pictures(ObjectReader& item, PictureSpec& pictures) {
  pictures.every = item.integer("every", {.low = 0,
                                          .high = 1000000,
                                          .fallback = pictures.every,
                                          .doc = "frames from picture to picture; 0: at times alone"});
  pictures.times =
      item.numbers("times", {.quantity = Quantity::kTime, .low = 0.0, .high = kMaxTime},
                   {.optional = true, .doc = "more pictures, at the frames nearest to these times"});
  item.optional_object("size", "pixels; the command line goes before", [&](ObjectReader& size) {
    pictures.width = size.integer("width", {.low = 16, .high = 8192, .fallback = pictures.width});
    pictures.height = size.integer("height", {.low = 16, .high = 8192, .fallback = pictures.height});
  });
  pictures.sheet = item.boolean("sheet", {.fallback = true, .doc = "all pictures small in one file"});
  pictures.sheet_columns =
      item.integer("sheet_columns", {.low = 1, .high = 64, .fallback = pictures.sheet_columns});
  pictures.sheet_cell_width =
      item.integer("sheet_cell_width", {.low = 16,
                                        .high = 4096,
                                        .fallback = pictures.sheet_cell_width,
                                        .doc = "pixels; at most the pictures' width"});
  read_overlays(item, pictures);
}

}  // namespace

void read_view(ObjectReader& root, Scene& scene) {
  root.optional_object("camera", "", [&](ObjectReader& item) { read_camera(item, scene, scene.camera); });
  scene.pictures.every = 30;
  root.optional_object("pictures", "", [&](ObjectReader& item) { read_pictures(item, scene.pictures); });
  root.optional_object("video", "used with --video", [&](ObjectReader& item) {
    scene.pictures.video_fps =
        item.optional_number(
                "fps", {.quantity = Quantity::kFrequency,
                        .low = 1.0,
                        .high = 1000.0,
                        .doc = "of the film, which runs at the scene's own speed; one per frame if absent"})
            .value_or(0.0);
    scene.pictures.video_quality = item.integer(
        "quality", {.low = 0, .high = 51, .fallback = 20, .doc = "H.264 rate factor: 0 lossless, 51 worst"});
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
