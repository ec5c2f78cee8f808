#pragma once

#include <memory>

#include "softpoint/core/deformable.h"
#include "softpoint/elastic/assembly.h"
#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// How a character lives in a world.
struct CharacterSettings {
  AssemblySettings joints;  // the accuracy dial
  // Segments have mass, carried by their joining surfaces, and move by themselves: a character may fly and
  // fall. Without it (as in the paper) parts are in balance at every moment and all motion comes from what
  // holds them: hands, and an exoskeleton, which is an elastic body with mass. Parts on an exoskeleton must
  // be without.
  bool inertia = false;
  bool weight = true;    // gravity bends the segments
  bool reaction = true;  // the exoskeleton feels the parts that hang on it (in the paper it does not)
};
// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const CharacterSettings& settings);

// An articulated elastic character in a world: parts whose ends are held by hands (hold, move), by vertices
// of an exoskeleton (attach) or by joining surfaces of other parts (the design). Its skin touches rigid and
// elastic bodies and can be grabbed like that of any deformable, forces going both ways.
class SOFTPOINT_API Character final : public Deformable {
 public:
  // The design's rest pose turned by `rotation` and moved by `origin` (m). Throws Error as check() does.
  explicit Character(const AssemblyDesign& design, const CharacterSettings& settings = {},
                     const Vec3& origin = Vec3::Zero(), const Mat3& rotation = Mat3::Identity());
  ~Character() override;

  const CharacterSettings& settings() const { return settings_; }
  // Shape, forces, bones, report of the last step.
  const Assembly& assembly() const { return assembly_; }
  // The dial, from the next step on.
  void set_joint_settings(const AssemblySettings& settings);

  // Ends held by hand; see Assembly. Moving an end wakes the character.
  void hold(const PartEnd& end, Hold what);
  void move(const PartEnd& end, const Vec3& position);
  void move(const PartEnd& end, const Vec3& position, const Mat3& turn);
  // Hangs the end of a part's bone on a vertex of an exoskeleton, offset as they lie now. The two do not
  // collide. Add the exoskeleton to the world before the character; it must outlive the attachment. One
  // character an exoskeleton. Throws Error for a vertex out of range and for a character with inertia.
  void attach(const PartEnd& end, ElasticBody& exoskeleton, int vertex);
  // Lets an end go, whatever held it.
  void release(const PartEnd& end);

  // Force (N) of its holder on an end, after the last step.
  Vec3 end_force(const PartEnd& end) const { return assembly_.force(end); }
  double elastic_energy() const override;  // J

 private:
  struct State;
  struct SkinForce {
    int point = 0;
    Vec3 force = Vec3::Zero();  // N
  };
  Character(Assembly assembly, const CharacterSettings& settings);

  void queue_impulse(int point, const Vec3& impulse) override;
  void predict(double dt) override;
  void compliance(std::span<const int> touched, double* blocks) override;
  void respond(std::span<const int> touched, std::span<const Vec3> impulses) override;
  void commit(double dt) override;
  std::string_view kind() const override { return "character"; }
  void archive_state(StateArchive& archive) override;
  void restored() override;

  void begin_inertia(double dt);
  void let_go_of_skin();
  void push_skin(int point, const Vec3& force);
  void take_off_forces();
  double held_give(int point) const;
  void add_response(const std::vector<SkinForce>& forces, double sign);
  void dent(int point, const Vec3& force);
  void take_joints(const std::vector<Vec3>& from);
  double farthest_joint(const std::vector<Vec3>& from) const;
  void solve_under_forces();
  void follow_exoskeletons();
  void load_exoskeletons();
  void steady_grounded(ElasticBody& exoskeleton);
  void put_end(const PartEnd& end, const Vec3& to);
  double measure_end_stiffness(int group);

  Assembly assembly_;
  CharacterSettings settings_;
  std::unique_ptr<State> state_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
