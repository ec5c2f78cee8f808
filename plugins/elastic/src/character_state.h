#pragma once

#include "assembly_impl.h"
#include "softpoint/elastic/character.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Displacement of a free vertex by a force on another one, the joints held, in the segment's frame (m/N).
Mat3 local_compliance(const SegmentModel& model, int row, int column);

// What a character keeps beside its assembly.
struct __attribute__((visibility("hidden"))) Character::State {
  // Where a point of the skin comes from: a joint's point, or a free vertex of a segment.
  struct SkinPoint {
    int group = 0;
    int segment = -1;  // of the group; -1 for a joint's point
    int free = 0;      // of the segment's model
    Eigen::Index at = 0, stride = 0;
    std::size_t index = 0;  // of a joint's point, in its group
  };
  struct SkinForce {
    int point = 0;
    Vec3 force = Vec3::Zero();  // N
  };
  // Linear response of a group to forces on the skin.
  struct Response {
    Eigen::VectorXd load, joints;  // N, m
    bool used = false;
  };
  struct Attachment {
    PartEnd end;
    ElasticBody* exoskeleton = nullptr;
    int vertex = 0;
    Vec3 offset = Vec3::Zero();  // m, from the vertex to the end, in the exoskeleton's frame
  };

  std::vector<SkinPoint> skin;
  std::vector<std::vector<double>> masses;   // kg, of each group's points
  std::vector<std::vector<double>> dampers;  // N s/m
  bool moves_by_itself = false;              // some mass or damping

  // From contact and handles: of the last step, and of this one.
  std::vector<SkinForce> forces, forces_now;
  // Joints' response (m/N) to unit forces on a point of the skin: three columns each, kept for the step.
  std::vector<Eigen::VectorXd> columns;
  std::vector<Eigen::Matrix3Xd> rows;  // displacement of a slotted point by the joints of its segment, world
  Eigen::Index largest_row = 0, largest_group = 0;
  Eigen::MatrixX3d gathered;        // of one segment's joints, a column for each axis of the force
  std::vector<int> slot_of;         // of each skin point, its first column; -1
  std::vector<int> slotted;         // points that have some
  std::vector<Response> responses;  // of each group
  std::vector<Vec3> shift;          // m, of each skin point
  bool responded = false;
  bool postponed = false;  // the joints are still to be solved, once the exoskeleton has found its place
  bool solved_once = false;
  std::vector<Vec3> queued;  // N s, of each skin point
  bool any_queued = false;

  std::vector<Attachment> attachments;
  std::vector<double> end_stiffness;  // N/m, of each group; 0 until measured
  std::vector<int> loaded;            // vertices of the exoskeleton
  std::vector<Vec3> loads;
  std::vector<double> load_stiffness;

  // What an exoskeleton did and felt in the last step, velocity and angular velocity, force and moment.
  struct Feeling {
    const ElasticBody* body = nullptr;
    bool known = false;
    Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();
    Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
  };
  std::vector<Feeling> feelings;
  Feeling& feeling_of(const ElasticBody& body) {
    for (Feeling& f : feelings) {
      if (f.body == &body) return f;
    }
    feelings.emplace_back().body = &body;
    return feelings.back();
  }
  std::vector<Vec3> arms;  // m, of an exoskeleton's points from its centre of mass

  Vec3 first_velocity = Vec3::Zero();  // m/s, of point 0 as it was left: gravity is what has been added
  Vec3 gravity = Vec3::Zero();
  double dt = 0;

  // Adds the load of the joints by a force on a point of the skin.
  void add_joint_load(const Assembly::Impl& impl, int point, const Vec3& force, Eigen::VectorXd& load) const;
  // Displacement (world) of a free vertex by those of its segment's joint points, 3 x 3J; nothing for a
  // joint's.
  void find_row(const Assembly::Impl& impl, int point, Eigen::Matrix3Xd& row) const;
  // Displacements of a segment's joint points under the three forces of a slot.
  void gather(const PartGroup::Segment& segment, int slot);
  // Adds the displacements of a whole group's skin by its response's joints.
  void shift_skin(Assembly::Impl& impl, std::size_t group, std::vector<Vec3>& points);
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
