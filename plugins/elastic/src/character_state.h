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
  // Points of a group's skin that forces act on in this step, in the order in which they were found, and how
  // the group gives way to them. Row 3 s + a belongs to axis a of point s.
  struct Touched {
    std::vector<int> points;
    Eigen::MatrixXd columns;     // m/N, of the joints' points by a unit force there
    Eigen::MatrixXd rows;        // displacement there by the joint points of its segment
    Eigen::MatrixXd compliance;  // m/N
    Eigen::VectorXd force;       // N, of respond()
    Eigen::VectorXd joints;      // m, which answer to it
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
  std::vector<int> points_now;
  std::vector<Touched> touched;  // of each group
  std::vector<int> slot_of;      // of each skin point, its place among the touched ones of its group; -1
  Eigen::Index largest_row = 0;  // of a segment's joint points, coordinates
  Eigen::MatrixXd gathered;      // columns at the joint points of one segment
  std::vector<double> scratch;   // of the dense kernels
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

  using Row = Eigen::Ref<Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  // Adds the load of the joints by a unit force on a point of the skin.
  void add_joint_load(const Assembly::Impl& impl, int point, const Vec3& force, Row load) const;
  // Displacement (world) of a free vertex by those of its segment's joint points, axis-major; nothing for a
  // joint's.
  void find_row(const Assembly::Impl& impl, int point, Touched& group) const;
  // Takes points in among those touched: their columns, rows and compliances with all others.
  void touch(Assembly::Impl& impl, std::span<const int> more);
  void find_compliance(const Assembly::Impl& impl, Touched& group, Eigen::Index known);
  void let_go();
  // Adds the displacements of a whole group's skin by those of its joints.
  void shift_skin(Assembly::Impl& impl, std::size_t group, std::vector<Vec3>& points);
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
