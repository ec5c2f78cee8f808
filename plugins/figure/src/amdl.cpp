#include "softpoint/figure/amdl.h"

#include <fstream>
#include <sstream>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr JointKind kTypes[] = {JointKind::kFree, JointKind::kHinge, JointKind::kBall, JointKind::kPrismatic,
                                JointKind::kFixed};
constexpr int kTypeCount = 5, kMaxLinks = 100000;

Link read_link(std::istringstream& line, const std::string& where) {
  Link link;
  int type = -1;
  if (!(line >> link.name)) throw Error(where + ": no name");
  const auto number = [&](const char* field, auto& value) {
    if (!(line >> value)) throw Error(where + " link '" + link.name + "': " + field + " is no number");
  };
  const auto vector = [&](const char* field, Vec3& value) {
    for (int k = 0; k < 3; ++k) number(field, value[k]);
  };
  number("parent", link.parent);
  number("type", type);
  if (type < 0 || type >= kTypeCount) {
    throw Error(where + " link '" + link.name + "': type = " + std::to_string(type) +
                "; permitted are 0 free, 1 hinge, 2 ball, 3 prismatic, 4 fixed");
  }
  link.joint = kTypes[type];
  vector("axis", link.axis);
  vector("origin", link.origin);
  number("mass", link.mass);
  vector("centre_of_mass", link.center_of_mass);
  Mat3& i = link.inertia;
  number("Ixx", i(0, 0));
  number("Iyy", i(1, 1));
  number("Izz", i(2, 2));
  number("Ixy", i(0, 1));
  number("Ixz", i(0, 2));
  number("Iyz", i(1, 2));
  i(1, 0) = i(0, 1);
  i(2, 0) = i(0, 2);
  i(2, 1) = i(1, 2);
  number("lower", link.lower);
  number("upper", link.upper);
  bool cone = false;
  if (type == 2 && !(line >> std::ws).eof()) {
    cone = true;
    number("swing_about", link.swing_about);
    number("swing_across", link.swing_across);
    vector("swing_axis", link.swing_axis);
  }
  std::string rest;
  if (line >> rest) throw Error(where + " link '" + link.name + "': '" + rest + "' after the last number");
  if (type != 1 && type != 3 && !cone) {
    link.lower = -1e9;
    link.upper = 1e9;
    link.axis = Vec3::UnitZ();
  }
  return link;
}

}  // namespace

FigureModel read_amdl(std::istream& in, const std::string& name) {
  std::vector<Link> links;
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    text = text.substr(0, text.find('#'));
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (links.size() >= static_cast<std::size_t>(kMaxLinks)) {
      throw Error(name + ": more than " + std::to_string(kMaxLinks) + " links; permitted are as many");
    }
    std::istringstream line(text);
    links.push_back(read_link(line, name + " line " + std::to_string(number)));
  }
  try {
    return FigureModel(std::move(links));
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

FigureModel read_amdl_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(path + " cannot be read");
  return read_amdl(file, path);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
