#include "softpoint/figure/urdf.h"

#include <fstream>
#include <iterator>

#include "softpoint/core/error.h"

#if SOFTPOINT_HAS_URDFDOM
#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
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

// What Bullet's readers know besides, said as the parser knows it: a spherical joint as a floating one whose
// name is kept, a capsule as the cylinder that it fills from end to end.
struct BulletDialect {
  std::string text;
  std::set<std::string> spherical;
};

void say_capsules_as_cylinders(TiXmlElement& at) {
  for (TiXmlElement* e = at.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    double radius = 0, length = 0;
    if (e->ValueStr() == "capsule" && e->QueryDoubleAttribute("radius", &radius) == TIXML_SUCCESS &&
        e->QueryDoubleAttribute("length", &length) == TIXML_SUCCESS) {
      e->SetValue("cylinder");
      e->SetAttribute("length", to_text(length + 2 * radius));
    }
  }
}

BulletDialect translated(const std::string& text) {
  BulletDialect result{text, {}};
  if (text.find("spherical") == std::string::npos && text.find("capsule") == std::string::npos) return result;
  TiXmlDocument document;
  document.Parse(text.c_str());
  TiXmlElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return result;  // the parser says what is wrong
  for (TiXmlElement* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const char *type = e->Attribute("type"), *name = e->Attribute("name");
    if (e->ValueStr() == "joint" && type != nullptr && name != nullptr && std::string(type) == "spherical") {
      result.spherical.insert(name);
      e->SetAttribute("type", "floating");
    }
    for (const char* kind : {"visual", "collision"}) {
      for (TiXmlElement* part = e->FirstChildElement(kind); part != nullptr;
           part = part->NextSiblingElement(kind)) {
        if (TiXmlElement* geometry = part->FirstChildElement("geometry"))
          say_capsules_as_cylinders(*geometry);
      }
    }
  }
  TiXmlPrinter printer;
  document.Accept(&printer);
  result.text = printer.Str();
  return result;
}

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

void add_capsule(const urdf::Collision& collision, int link, std::vector<LinkCapsule>& to) {
  if (!collision.geometry) return;
  double radius = 0, length = 0;  // of the capsule from end to end
  Vec3 axis = Vec3::UnitZ();
  switch (collision.geometry->type) {
    case urdf::Geometry::SPHERE:
      radius = static_cast<const urdf::Sphere&>(*collision.geometry).radius;
      length = 2 * radius;
      break;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(*collision.geometry);
      length = cylinder.length;
      radius = std::min(cylinder.radius, 0.5 * length);
      break;
    }
    case urdf::Geometry::BOX: {
      const Vec3 edges = from(static_cast<const urdf::Box&>(*collision.geometry).dim);
      int longest = 0;
      length = edges.maxCoeff(&longest);
      radius = 0.5 * edges.minCoeff();
      axis = Vec3::Unit(longest);
      break;
    }
    default:
      return;
  }
  if (!(radius > 0)) return;
  const Vec3 center = from(collision.origin.position);
  const Vec3 half = from(collision.origin.rotation) * axis * (0.5 * length - radius);
  to.push_back({link, center - half, center + half, radius});
}

void set_joint(const urdf::Joint& from_joint, const std::string& where, bool under_world, bool spherical,
               Link& link) {
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
      if (spherical) {
        link.joint = JointKind::kBall;
        break;
      }
      if (!under_world) refuse("is floating; permitted only on a root without mass");
      link.joint = JointKind::kFree;
      link.parent = -1;
      break;
    default:
      refuse(
          "is planar or unknown; permitted are revolute, continuous, prismatic, spherical, fixed and "
          "floating");
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
  if (link.joint != JointKind::kHinge && link.joint != JointKind::kPrismatic) {
    link.axis = Vec3::UnitZ();
    link.friction = 0;
    if (link.joint != JointKind::kBall) link.damping = 0;
  }
}

// What comes of a description while its tree is walked.
struct Robot {
  const std::string& where;  // for messages
  const std::set<std::string>& spherical;
  std::vector<Link> links;
  std::vector<LinkCapsule> capsules;

  void add_shapes(const urdf::Link& of) {
    for (const auto& collision : of.collision_array) {
      if (collision) add_capsule(*collision, static_cast<int>(links.size()) - 1, capsules);
    }
  }

  void add_below(const urdf::Link& robot_link, int parent, bool under_world) {
    for (const auto& child : robot_link.child_links) {
      const urdf::Joint& joint = *child->parent_joint;
      Link link;
      link.name = child->name;
      link.parent = parent;
      set_inertial(*child, link);
      set_joint(joint, where, under_world, spherical.count(joint.name) > 0, link);
      links.push_back(link);
      add_shapes(*child);
      add_below(*child, static_cast<int>(links.size()) - 1,
                under_world && link.joint == JointKind::kFixed && link.mass == 0);
    }
  }
};

}  // namespace

bool has_urdf() { return true; }

FigureModel read_urdf(const std::string& text, const std::string& name, UrdfBase base,
                      std::vector<LinkCapsule>* capsules) {
  const BulletDialect dialect = translated(text);
  urdf::ModelInterfaceSharedPtr parsed;
  {
    ParserLog log;
    try {
      parsed = urdf::parseURDF(dialect.text);
    } catch (const std::exception& error) {  // numbers that are none
      throw Error(name + ": " + error.what());
    }
    if (!parsed) throw Error(name + ": no robot description: " + (log.first.empty() ? "unknown" : log.first));
  }
  const urdf::LinkConstSharedPtr root = parsed->getRoot();
  if (!root) throw Error(name + ": no root link; permitted is one");
  Robot robot{name, dialect.spherical, std::vector<Link>(1), {}};
  Link& first = robot.links[0];
  first.name = root->name;
  set_inertial(*root, first);
  const bool free = base == UrdfBase::kFree || (base == UrdfBase::kAuto && first.mass > 0);
  first.joint = free ? JointKind::kFree : JointKind::kFixed;
  const bool under_world = !free && first.mass == 0;
  robot.add_shapes(*root);
  robot.add_below(*root, 0, under_world);
  try {
    FigureModel model(std::move(robot.links));
    if (capsules != nullptr) *capsules = std::move(robot.capsules);
    return model;
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

#else

bool has_urdf() { return false; }

FigureModel read_urdf(const std::string&, const std::string& name, UrdfBase, std::vector<LinkCapsule>*) {
  throw Error(name + ": this library was built without liburdfdom; permitted are other formats");
}

#endif

FigureModel read_urdf_file(const std::string& path, UrdfBase base, std::vector<LinkCapsule>* capsules) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + " cannot be read");
  return read_urdf(std::string(std::istreambuf_iterator<char>(file), {}), path, base, capsules);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
