#include "figure_state_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "figure_joints.h"
#include "json_document.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using figure::FigureModel;
using figure::FigureState;
using figure::JointKind;
using nlohmann::json;

[[noreturn]] void refuse_state(const std::string& at, const json& value, const std::string& permitted) {
  std::string shown = value.dump();
  if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
  throw Error(fmt::format("{} = {}; permitted is {}", at, shown, permitted));
}

double number_of(const json& value, const std::string& at) {
  if (!value.is_number()) refuse_state(at, value, "a number");
  const double number = value.get<double>();
  check_range(at, number, -1e9, 1e9);
  return number;
}

void numbers_of(const json& value, const std::string& at, int count, const char* what, double* to) {
  if (!value.is_array() || value.size() != static_cast<std::size_t>(count)) {
    refuse_state(at, value, fmt::format("a list of {} numbers: {}", count, what));
  }
  for (int k = 0; k < count; ++k) {
    to[k] = number_of(value[static_cast<std::size_t>(k)], fmt::format("{}/{}", at, k));
  }
}

void only_keys(const json& object, const std::string& at, std::initializer_list<const char*> keys) {
  std::string names;
  for (const char* key : keys) names += fmt::format("{}{}", names.empty() ? "" : ", ", key);
  if (!object.is_object()) refuse_state(at, object, fmt::format("an object with the keys {}", names));
  for (const auto& [key, value] : object.items()) {
    bool known = false;
    for (const char* wanted : keys) known = known || key == wanted;
    if (!known) throw Error(fmt::format("{}/{}: unknown; permitted are {}", at, pointer_token(key), names));
  }
}

void read_base(const json& base, const std::string& at, const FigureModel& model, FigureState& state) {
  only_keys(base, at, {"position", "orientation", "angular_velocity", "velocity"});
  const int link = find_base(model);
  if (link < 0) throw Error(at + ": the model stands on the world; permitted is no base");
  double* q = state.q.data() + model.position_offset(link);
  double* qd = state.qd.data() + model.velocity_offset(link);
  const auto read = [&](const char* key, int count, const char* what, double* to) {
    if (base.contains(key)) numbers_of(base[key], at + "/" + key, count, what, to);
  };
  read("position", 3, "m, world axes", q);
  read("orientation", 4, "quaternion w, x, y, z", q + 3);
  read("angular_velocity", 3, "rad/s, world axes", qd);
  read("velocity", 3, "m/s, world axes", qd + 3);
}

void read_joints(const json& list, const std::string& at, const FigureModel& model, bool rates,
                 std::vector<double>& to) {
  std::vector<int> joints;
  for (int i = 0; i < model.link_count(); ++i) {
    const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
    if (kind != JointKind::kFixed && kind != JointKind::kFree) joints.push_back(i);
  }
  if (!list.is_array() || list.size() != joints.size()) {
    refuse_state(
        at, list,
        fmt::format("a list of {} entries, one a joint but the base's, in the model's order", joints.size()));
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const figure::Link& link = model.links()[static_cast<std::size_t>(joints[k])];
    const std::string entry = fmt::format("{}/{} (joint '{}')", at, k, link.name);
    double* numbers =
        to.data() + (rates ? model.velocity_offset(joints[k]) : model.position_offset(joints[k]));
    if (link.joint != JointKind::kBall) {
      *numbers = number_of(list[k], entry);
    } else if (rates) {
      numbers_of(list[k], entry, 3, "rad/s, axes of the child", numbers);
    } else {
      numbers_of(list[k], entry, 4, "quaternion w, x, y, z, child to parent", numbers);
    }
  }
}

}  // namespace

FigureState read_figure_state(std::string_view text, const std::string& file, const FigureModel& model) {
  const json document = parse_json(text, file);
  const std::string at = file + ": ";
  only_keys(document, at, {"base", "q", "qd"});
  FigureState state = rest_state(model);
  if (document.contains("base")) read_base(document["base"], at + "/base", model, state);
  if (document.contains("q")) read_joints(document["q"], at + "/q", model, false, state.q);
  if (document.contains("qd")) read_joints(document["qd"], at + "/qd", model, true, state.qd);
  try {
    check_state(model, state);
  } catch (const Error& error) {
    throw Error(at + error.what());
  }
  return state;
}

FigureState read_figure_state(const std::filesystem::path& path, const FigureModel& model) {
  return read_figure_state(read_text_file(path), path.string(), model);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
