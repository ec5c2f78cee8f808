#include "trace_recorder.h"

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>

#include "bullet_border.h"
#include "metrics_penetration.h"
#include "metrics_sheet.h"
#include "metrics_state.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

// A field of the header: quoted if the name of a body needs it (RFC 4180).
std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n\r") == std::string::npos) {
    return field;
  }
  std::string result = "\"";
  for (const char c : field) {
    result.append(c == '"' ? 2 : 1, c);
  }
  result += '"';
  return result;
}

}  // namespace

TraceRecorder::TraceRecorder(Player& player) : player_(player) {
  head();
  row();
}

void TraceRecorder::record() { row(); }

void TraceRecorder::head() {
  csv_ = "time,kinetic,elastic,potential,contacts,vertex_depth,corner_depth";
  const Scene& scene = player_.scene();
  const auto columns = [&](const std::string& name, std::initializer_list<std::string_view> fields) {
    for (const std::string_view field : fields) {
      csv_ += fmt::format(",{}", quoted(fmt::format("{}.{}", name, field)));
    }
  };
  for (std::size_t k = 0; k < scene.deformables.size(); ++k) {
    columns(scene.deformables[k].name, {"x", "y", "z", "vx", "vy", "vz", "elastic"});
    if (player_.sheet(k) != nullptr) {
      columns(scene.deformables[k].name,
              {"bubbles", "volume", "gauge", "stretch", "stretch_99", "stretch_mean", "contact_area",
               "contact_force", "lowest", "highest"});
    }
  }
  for (const FigureSpec& spec : scene.figures) columns(spec.name, {"x", "y", "z", "vx", "vy", "vz"});
  for (const RigidBodySpec& spec : scene.rigid_bodies) {
    if (spec.mass > 0.0) {
      columns(spec.name, {"x", "y", "z", "vx", "vy", "vz"});
    }
  }
  for (const std::string& handle : scene.handles) {
    columns(handle, {"fx", "fy", "fz"});
  }
  csv_ += "\n";
}

void TraceRecorder::row() {
  const auto put = [&](double value) { csv_ += fmt::format(",{}", to_text(value)); };
  const auto put_vec = [&](const Vec3& v) {
    for (int k = 0; k < 3; ++k) {
      put(v[k]);
    }
  };
  const MechanicalState state = measure_state(player_);
  csv_ += to_text(player_.time());
  put(state.kinetic);
  put(state.elastic);
  put(state.potential);
  csv_ += fmt::format(",{}", player_.system().contacts().size());
  const Penetration penetration = measure_penetration(player_);
  put(penetration.vertex.depth);
  put(penetration.corner.depth);
  for (std::size_t k = 0; k < player_.deformable_count(); ++k) {
    const Deformable& body = player_.deformable(k);
    put_vec(body.center_of_mass());
    put_vec(body.momentum() / body.total_mass());
    put(body.elastic_energy());
    if (const Sheet* sheet = player_.sheet(k); sheet != nullptr) {
      const SheetState cloth = sheet->measure();
      const Heights heights = heights_of(body);
      for (const double value :
           {static_cast<double>(cloth.bubbles), cloth.volume, cloth.gauge, cloth.stretch, cloth.stretch_99,
            cloth.stretch_mean, cloth.contact_area, cloth.contact_force, heights.lowest, heights.highest}) {
        put(value);
      }
    }
  }
  for (std::size_t k = 0; k < player_.figure_count(); ++k) {
    put_vec(player_.figure(k).center());
    put_vec(player_.figure(k).velocity());
  }
  for (std::size_t k = 0; k < player_.rigid_count(); ++k) {
    if (player_.rigid(k).mass() > 0.0) {
      put_vec(player_.center({false, static_cast<int>(k)}));
      put_vec(from_bullet(player_.rigid(k).body().getLinearVelocity()));
    }
  }
  for (std::size_t k = 0; k < player_.handles().count(); ++k) {
    put_vec(player_.handles().force(k));
  }
  csv_ += "\n";
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
