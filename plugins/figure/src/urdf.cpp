#include "softpoint/figure/urdf.h"

#include <fstream>
#include <iterator>

#include "softpoint/core/error.h"

#if SOFTPOINT_HAS_URDFDOM
#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#endif

namespace softpoint::inline SOFTPOINT_ABI::figure {

#if SOFTPOINT_HAS_URDFDOM
namespace {

// What the parser complains of, kept instead of printed.
class ParserLog : public console_bridge::OutputHandler {
 public:
  ParserLog() : before_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  ~ParserLog() override { console_bridge::useOutputHandler(before_); }
  ParserLog(const ParserLog&) = delete;
  ParserLog& operator=(const ParserLog&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first.empty()) first = text;
  }
  std::string first;

 private:
  console_bridge::OutputHandler* before_;
};

Vec3 from(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }
Mat3 from(const urdf::Rotation& r) {
  return Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
}

void set_inertial(const urdf::Link& from_link, Link& link) {
  if (!from_link.inertial) return;
  const urdf::Inertial& inertial = *from_link.inertial;
  link.mass = inertial.mass;
  link.center_of_mass = from(inertial.origin.position);
  Mat3 i;
  i << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz, inertial.ixz,
      inertial.iyz, inertial.izz;
  const Mat3 turn = from(inertial.origin.rotation);
  const Mat3 turned = turn * i * turn.transpose();
  link.inertia = 0.5 * (turned + turned.transpose());
}

void set_joint(const urdf::Joint& from_joint, const std::string& where, bool under_world, Link& link) {
  const auto refuse = [&](const std::string& what) {
    throw Error(where + " joint '" + from_joint.name + "' " + what);
  };
  link.joint_name = from_joint.name;
  link.origin = from(from_joint.parent_to_joint_origin_transform.position);
  link.orientation = from(from_joint.parent_to_joint_origin_transform.rotation);
  link.axis = from(from_joint.axis);
  if (from_joint.mimic) refuse("mimics another; permitted are joints of their own");
  switch (from_joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      link.joint = JointKind::kHinge;
      break;
    case urdf::Joint::PRISMATIC:
      link.joint = JointKind::kPrismatic;
      break;
    case urdf::Joint::FIXED:
      link.joint = JointKind::kFixed;
      break;
    case urdf::Joint::FLOATING:
      if (!under_world) refuse("is floating; permitted only on a root without mass");
      link.joint = JointKind::kFree;
      link.parent = -1;
      break;
    default:
      refuse("is planar or unknown; permitted are revolute, continuous, prismatic, fixed and floating");
  }
  const bool ranged = from_joint.type == urdf::Joint::REVOLUTE || from_joint.type == urdf::Joint::PRISMATIC;
  if (ranged && from_joint.limits) {
    link.lower = from_joint.limits->lower;
    link.upper = from_joint.limits->upper;
  }
  if (from_joint.dynamics) {
    link.damping = from_joint.dynamics->damping;
    link.friction = from_joint.dynamics->friction;
  }
  if (link.joint == JointKind::kFixed || link.joint == JointKind::kFree) {
    link.axis = Vec3::UnitZ();
    link.damping = link.friction = 0;
  }
}

void add_below(const urdf::Link& robot_link, int parent, bool under_world, const std::string& where,
               std::vector<Link>& links) {
  for (const auto& child : robot_link.child_links) {
    Link link;
    link.name = child->name;
    link.parent = parent;
    set_inertial(*child, link);
    set_joint(*child->parent_joint, where, under_world, link);
    links.push_back(link);
    add_below(*child, static_cast<int>(links.size()) - 1,
              under_world && link.joint == JointKind::kFixed && link.mass == 0, where, links);
  }
}

}  // namespace

bool has_urdf() { return true; }

FigureModel read_urdf(const std::string& text, const std::string& name, UrdfBase base) {
  urdf::ModelInterfaceSharedPtr robot;
  {
    ParserLog log;
    try {
      robot = urdf::parseURDF(text);
    } catch (const std::exception& error) {  // numbers that are none
      throw Error(name + ": " + error.what());
    }
    if (!robot) throw Error(name + ": no robot description: " + (log.first.empty() ? "unknown" : log.first));
  }
  const urdf::LinkConstSharedPtr root = robot->getRoot();
  if (!root) throw Error(name + ": no root link; permitted is one");
  std::vector<Link> links(1);
  links[0].name = root->name;
  set_inertial(*root, links[0]);
  const bool free = base == UrdfBase::kFree || (base == UrdfBase::kAuto && links[0].mass > 0);
  links[0].joint = free ? JointKind::kFree : JointKind::kFixed;
  add_below(*root, 0, !free && links[0].mass == 0, name, links);
  try {
    return FigureModel(std::move(links));
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

#else

bool has_urdf() { return false; }

FigureModel read_urdf(const std::string&, const std::string& name, UrdfBase) {
  throw Error(name + ": this library was built without liburdfdom; permitted are other formats");
}

#endif

FigureModel read_urdf_file(const std::string& path, UrdfBase base) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + " cannot be read");
  return read_urdf(std::string(std::istreambuf_iterator<char>(file), {}), path, base);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
