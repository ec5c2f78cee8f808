#include "figure_joints.h"

#include <fmt/format.h>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

using figure::FigureModel;
using figure::JointKind;

int find_joint(const FigureModel& model, const std::string& name, const std::string& where) {
  std::string names;
  for (int i = 0; i < model.link_count(); ++i) {
    const figure::Link& link = model.links()[static_cast<std::size_t>(i)];
    if (link.joint == JointKind::kFixed) continue;
    if (model.joint_name(i) == name) return i;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", model.joint_name(i));
  }
  throw Error(fmt::format("{} '{}': no joint has that name; permitted are {}", where, name, names));
}

int find_base(const FigureModel& model) {
  int base = -1;
  for (int i = 0; i < model.link_count(); ++i) {
    if (model.links()[static_cast<std::size_t>(i)].joint != JointKind::kFree) continue;
    if (base >= 0) {
      throw Error(fmt::format("the model has the free links '{}' and '{}'; permitted is one",
                              model.links()[static_cast<std::size_t>(base)].name,
                              model.links()[static_cast<std::size_t>(i)].name));
    }
    base = i;
  }
  return base;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
