#include "player_pictures.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <system_error>

#include "softpoint/core/error.h"
#include "softpoint/picture/png.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr picture::Color kForceColor{0.85F, 0.16F, 0.12F};
constexpr picture::Color kHandleColor{0.10F, 0.32F, 0.80F};
constexpr double kArrowRadius = 0.006;  // m
constexpr double kLeastForce = 0.05;    // N, weaker ones have no arrow

picture::Color to_color(const Rgb& rgb) {
  return {static_cast<float>(rgb.x()), static_cast<float>(rgb.y()), static_cast<float>(rgb.z())};
}

picture::RenderSettings render_settings(const PictureOptions& options) {
  picture::RenderSettings settings;
  settings.width = options.width;
  settings.height = options.height;
  return settings;
}

picture::ContactSheetSettings sheet_settings(const PictureSpec& spec, int width) {
  picture::ContactSheetSettings settings;
  settings.columns = spec.sheet_columns;
  settings.cell_width = std::min(spec.sheet_cell_width, width);
  return settings;
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw Error(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
  }
}

}  // namespace

std::unique_ptr<PictureOutput> make_picture_output(Player& player, const PictureOptions& options) {
  return std::make_unique<PictureTaker>(player, options);
}

PictureTaker::PictureTaker(Player& player, const PictureOptions& options)
    : player_(player),
      options_(options),
      renderer_((make_folder(options.folder), render_settings(options))),
      painter_(renderer_),
      pieces_(player, renderer_, painter_),
      curves_(player),
      sheet_(sheet_settings(player.scene().pictures, options.width)) {
  const PictureSpec& spec = player.scene().pictures;
  const double step = player.scene().world.time_step;
  for (const double time : spec.times) {
    frames_.insert(static_cast<int>(std::lround(time / step)));
  }
  if (const auto& follow = player.scene().camera.follow) {
    followed_from_ = player.center(*follow);
  }
  film_fps_ = spec.video_fps > 0.0 ? spec.video_fps : std::clamp(std::round(1.0 / step), 1.0, 1000.0);
  if (options.video) {
    film_ = std::make_unique<picture::VideoWriter>(
        (options.folder / "video.mp4").string(), options.width, options.height,
        picture::VideoSettings{.frames_per_second = film_fps_, .quality = spec.video_quality});
  }
  dress();
}

// Colours and what is hidden.
void PictureTaker::dress() {
  const Scene& scene = player_.scene();
  const auto wear = [&](const btCollisionObject& object, const std::optional<Rgb>& color, bool wireframe) {
    picture::Material material = painter_.material(object);
    if (color) {
      material.color = to_color(*color);
    }
    material.wireframe = wireframe;
    painter_.set_material(object, material);
  };
  wireframe_ = player_.overlays().wireframe;
  for (std::size_t k = 0; k < player_.deformable_count(); ++k) {
    wear(player_.deformable(k), scene.deformables[k].color, wireframe_);
  }
  for (std::size_t k = 0; k < player_.figure_count(); ++k) {
    const figure::ArticulatedController& controller = player_.figure(k).controller();
    for (int i = 0; i < controller.body_count(); ++i) {
      wear(controller.body(i), scene.figures[k].color, false);
    }
  }
  for (std::size_t k = 0; k < player_.rigid_count(); ++k) {
    const btCollisionObject& object = player_.rigid(k).body();
    wear(object, scene.rigid_bodies[k].color, false);
    painter_.set_visible(object, scene.rigid_bodies[k].visible);
  }
}

bool PictureTaker::picture_due() const {
  const int every = player_.scene().pictures.every;
  return options_.pictures &&
         ((every > 0 && player_.frame() % every == 0) || frames_.contains(player_.frame()));
}

// The film has the frame k at the time k / fps; it may be slower or faster than the scene's steps.
int PictureTaker::film_frames_due() const {
  if (film_ == nullptr) {
    return 0;
  }
  const double shown = std::floor(player_.time() * film_fps_ + 1e-6) + 1.0;
  return static_cast<int>(shown) - film_->frame_count();
}

void PictureTaker::take() {
  if (options_.pictures && curves_.wanted()) curves_.record();
  const bool picture = picture_due();
  const int film_frames = film_frames_due();
  if (!picture && film_frames <= 0) {
    return;
  }
  draw();
  for (int k = 0; k < film_frames; ++k) {
    film_->add(image_);
  }
  if (picture) {
    files_.push_back(fmt::format("frame_{:06}.png", player_.frame()));
    picture::write_png((options_.folder / files_.back()).string(), image_);
    if (player_.scene().pictures.sheet) {
      sheet_.add(image_, fmt::format("{:.2f} s", player_.time()));
    }
  }
}

void PictureTaker::finish() {
  if (sheet_.count() > 0) {
    files_.push_back("sheet.png");
    picture::write_png((options_.folder / files_.back()).string(), sheet_.image());
  }
  if (options_.pictures && curves_.wanted()) {
    files_.push_back("curves.png");
    picture::write_png((options_.folder / files_.back()).string(), curves_.image());
  }
  if (film_ != nullptr) {
    film_->close();
    files_.push_back("video.mp4");
  }
}

picture::Camera PictureTaker::camera() const {
  const CameraSpec& spec = player_.scene().camera;
  picture::Camera camera;
  camera.eye = spec.eye_path.empty() ? spec.eye : spec.eye_path.at(player_.time());
  camera.target = spec.target_path.empty() ? spec.target : spec.target_path.at(player_.time());
  camera.up = spec.up;
  camera.vertical_fov_degrees = spec.fov * 180.0 / std::numbers::pi;
  if (followed_from_) {
    const Vec3 moved = player_.center(*spec.follow) - *followed_from_;
    camera.eye += moved;
    camera.target += moved;
  }
  return camera;
}

std::string PictureTaker::caption() const {
  std::string text = player_.scene().pictures.text;
  if (player_.overlays().time) {
    text += fmt::format("{}{:.2f} s", text.empty() ? "" : "\n", player_.time());
  }
  return text;
}

void PictureTaker::draw() {
  if (wireframe_ != player_.overlays().wireframe) {
    dress();
  }
  renderer_.begin(camera());
  painter_.draw(player_.world());
  pieces_.draw();
  draw_overlays();
  if (const std::string text = caption(); !text.empty()) {
    renderer_.draw_text(12, 12, text);
  }
  renderer_.finish(image_);
}

// A contact force always points into one of the two bodies: the line shows it through them.
void PictureTaker::draw_force(const Vec3& point, const Vec3& vector, picture::Color color) {
  renderer_.draw_arrow(point, vector, color, kArrowRadius);
  renderer_.draw_line(point, point + vector, color, 2.5, true);
}

void PictureTaker::draw_overlays() {
  const Overlays& overlays = player_.overlays();
  const double scale = player_.scene().pictures.meters_per_newton;
  for (const ContactPoint& contact : player_.system().contacts()) {
    if (overlays.contacts) {
      renderer_.draw_point(contact.point, kForceColor, 2.5, true);
    }
    if (overlays.forces && contact.force.norm() > kLeastForce) {
      draw_force(contact.point, scale * contact.force, kForceColor);
    }
  }
  const HandleSet& handles = player_.handles();
  for (std::size_t h = 0; h < handles.count(); ++h) {
    if (const auto end = handles.held_end(h)) {
      renderer_.draw_point(*end, kHandleColor, 4.5, true);
      const Vec3 force = handles.force(h);
      if (overlays.forces && force.norm() > kLeastForce) {
        draw_force(*end, scale * force, kHandleColor);
      }
    }
    for (const HandleSet::Held& held : handles.held(h)) {
      const Vec3& point = held.body->points()[static_cast<std::size_t>(held.point)];
      const Vec3 target = handles.target(h, held);
      renderer_.draw_point(point, kHandleColor, 4.5, true);
      renderer_.draw_line(point, target, kHandleColor, 2.0, true);
      const Vec3 force = player_.system().handle_force(held.id);
      if (overlays.forces && force.norm() > kLeastForce) {
        draw_force(point, scale * force, kHandleColor);
      }
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
