#include "character_actor.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>

#include "player_handles.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using elastic::PartEnd;

PartEnd end_of(int index) { return {index / 2, index % 2 != 0}; }

// The turn that takes the arms `from` nearest to the arms `to` (Kabsch).
Mat3 best_turn(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) sum += to[i] * from[i].transpose();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

std::vector<Vec3> arms(std::vector<Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  for (Vec3& p : points) p -= mean;
  return points;
}

class CharacterArticulation final : public Articulation {
 public:
  CharacterArticulation(elastic::Character& character, const CharacterPlan& plan, const Placement& placement)
      : character_(character), placement_(placement) {
    for (const PartPlan& part : plan.parts) {
      names_.push_back(part.design.name);
      bool lighter = false;
      const int p = static_cast<int>(names_.size()) - 1;
      for (int k = 0; k < static_cast<int>(part.shapes.size()); ++k) {
        add_piece(p, k, part.color, lighter);
        lighter = !lighter;
      }
    }
    for (const HoldPlan& hold : plan.holds) held_.push_back(hold.end);
    for (const AttachmentPlan& attachment : plan.attachments) held_.push_back(attachment.end);
  }

  void hold(int end, bool surface) override {
    character_.hold(end_of(end), surface ? elastic::Hold::kSurface : elastic::Hold::kPoint);
    if (!holds(end_of(end))) held_.push_back(end_of(end));
  }
  void release(int end) override {
    character_.release(end_of(end));
    std::erase_if(held_, [&](const PartEnd& e) { return same(e, end_of(end)); });
  }
  Vec3 position(int end) const override {
    const auto bone = character_.assembly().bone(end_of(end).part);
    return end_of(end).tip ? bone.back() : bone.front();
  }
  Vec3 turn(int end) const override {
    const Eigen::AngleAxisd turn(end_turn(end_of(end)));
    return turn.angle() * turn.axis();
  }
  void move(int end, const Vec3& position, const std::optional<Vec3>& turn) override {
    if (turn) {
      const double angle = turn->norm();
      const Vec3 axis = angle > 0.0 ? Vec3(*turn / angle) : Vec3(Vec3::UnitX());
      character_.move(end_of(end), position, Eigen::AngleAxisd(angle, axis).toRotationMatrix());
    } else {
      character_.move(end_of(end), position);
    }
  }
  Vec3 force(int end) const override { return character_.end_force(end_of(end)); }

  const std::vector<Piece>& pieces() const override { return pieces_; }
  int visible_points() const override { return character_.assembly().visible_points(); }
  int visible_faces() const override { return static_cast<int>(character_.assembly().faces().size()); }
  int segments() const override { return static_cast<int>(pieces_.size()); }

  ArticulationState measure() const override {
    const elastic::Assembly& assembly = character_.assembly();
    const elastic::AssemblyReport& report = assembly.report();
    const elastic::JointQuality quality = assembly.quality();
    ArticulationState state{quality.gap, quality.kink, assembly.volume(), {}, {}};
    for (int p = 0; p < static_cast<int>(names_.size()); ++p) {
      ArticulationState::Part part;
      const auto bone = assembly.bone(p);
      for (std::size_t k = 1; k < bone.size(); ++k) part.length += (bone[k] - bone[k - 1]).norm();
      const Vec3 axis = rest_rotation(p).col(2);
      const Vec3 a = end_turn({p, false}) * axis, b = end_turn({p, true}) * axis;
      part.bend = std::atan2(a.cross(b).norm(), a.dot(b));
      state.parts.push_back(part);
    }
    for (const PartEnd& end : held_) {
      state.held.push_back({names_[static_cast<std::size_t>(end.part)] + (end.tip ? ".tip" : ".root"),
                            character_.end_force(end)});
    }
    state.iterations = report.iterations;
    state.residual = report.residual;
    state.balanced = report.balanced;
    state.segments_solved = report.segments_skinned;
    return state;
  }

 private:
  static bool same(const PartEnd& a, const PartEnd& b) { return a.part == b.part && a.tip == b.tip; }
  bool holds(const PartEnd& end) const {
    return std::any_of(held_.begin(), held_.end(), [&](const PartEnd& e) { return same(e, end); });
  }

  const elastic::PartDesign& part(int p) const {
    return character_.assembly().design().parts[static_cast<std::size_t>(p)];
  }
  Mat3 rest_rotation(int p) const { return placement_.rotation * part(p).rotation; }

  // From the rest pose, in the world.
  Mat3 end_turn(const PartEnd& end) const {
    const elastic::PartDesign& design = part(end.part);
    const int segment = end.tip ? static_cast<int>(design.segments.size()) - 1 : 0;
    const elastic::SegmentModel& model = *design.segments[static_cast<std::size_t>(segment)];
    std::vector<Vec3> rest, now;
    for (const int v : model.interfaces[end.tip ? 1 : 0]) {
      rest.push_back(rest_rotation(end.part) * model.mesh.vertices[static_cast<std::size_t>(v)]);
      const int point = character_.assembly().point_of({end.part, segment, v});
      now.push_back(character_.points()[static_cast<std::size_t>(point)]);
    }
    return best_turn(arms(std::move(rest)), arms(std::move(now)));
  }

  // The faces of a segment that are seen: all between points of its own.
  void add_piece(int p, int segment, const std::optional<Rgb>& color, bool lighter) {
    const elastic::Assembly& assembly = character_.assembly();
    const TriangleMesh& mesh = part(p).segments[static_cast<std::size_t>(segment)]->mesh;
    std::vector<Triangle> own;
    for (const Triangle& t : mesh.triangles) {
      own.push_back({assembly.point_of({p, segment, t[0]}), assembly.point_of({p, segment, t[1]}),
                     assembly.point_of({p, segment, t[2]})});
    }
    std::sort(own.begin(), own.end());
    Piece piece{{}, color, lighter};
    for (const Triangle& t : assembly.faces()) {
      if (std::binary_search(own.begin(), own.end(), t)) piece.faces.push_back(t);
    }
    pieces_.push_back(std::move(piece));
  }

  elastic::Character& character_;
  Placement placement_;
  std::vector<std::string> names_;
  std::vector<PartEnd> held_;
  std::vector<Piece> pieces_;
};

int exoskeleton_vertex(const AttachmentPlan& attachment, const elastic::ElasticBody& exoskeleton,
                       const elastic::Character& character) {
  if (attachment.vertex) {
    return *attachment.vertex;
  }
  const auto bone = character.assembly().bone(attachment.end.part);
  return nearest_vertex(exoskeleton,
                        attachment.near.value_or(attachment.end.tip ? bone.back() : bone.front()));
}

}  // namespace

DeformableActor make_character(const CharacterPlan& plan, const MakeContext& context) {
  if (!context.motion.linear.isZero(0) || !context.motion.angular.isZero(0)) {
    throw Error("velocity, angular_velocity: permitted is 0: characters begin at rest");
  }
  std::vector<std::shared_ptr<const elastic::SegmentModel>> models;
  for (const NamedShape& shape : plan.shapes) {
    models.push_back(elastic::make_segment(shape.shape, plan.material));
  }
  auto character = std::make_unique<elastic::Character>(
      design_of(plan, models), plan.settings, context.placement.position, context.placement.rotation);
  for (const HoldPlan& hold : plan.holds) character->hold(hold.end, hold.what);
  for (const AttachmentPlan& attachment : plan.attachments) {
    auto& body = *context.before[static_cast<std::size_t>(plan.exoskeleton)].body;
    auto& exoskeleton = dynamic_cast<elastic::ElasticBody&>(body);
    character->attach(attachment.end, exoskeleton, exoskeleton_vertex(attachment, exoskeleton, *character));
  }
  character->set_joint_settings(
      plan.settings.joints);
  DeformableActor actor;
  actor.articulation = std::make_unique<CharacterArticulation>(*character, plan, context.placement);
  actor.body = std::move(character);
  return actor;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
