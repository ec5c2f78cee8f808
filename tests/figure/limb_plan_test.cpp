// Limbs side by side in vectors: the same accelerations, and the same answers afterwards, as body by body.
#include "limb_plan.h"

#include <gtest/gtest.h>

#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_dynamics.h"
#include "support.h"
#include "tree.h"

namespace softpoint::figure {
namespace {

// Hinges only: limbs of different lengths on a trunk, some of them on each other.
FigureModel limbed(RandomFigures& random, int limbs, bool floating) {
  std::vector<Link> links = random.model(3, floating).links();
  for (Link& link : links) {
    if (link.joint != JointKind::kFree) link.joint = JointKind::kHinge;
  }
  links[1].parent = 0;
  links[2].parent = 1;
  for (int limb = 0; limb < limbs; ++limb) {
    const int length = 4 + random.below(4);
    const int from = random.below(static_cast<int>(links.size()));
    for (int k = 0; k < length; ++k) {
      Link link = random.model(2, false).links()[0];
      link.name = std::to_string(limb) + "." + std::to_string(k);
      link.parent = k == 0 ? from : static_cast<int>(links.size()) - 1;
      if (random.coin()) link.origin = Vec3::Zero();
      if (random.coin()) link.orientation = Mat3::Identity();
      if (random.coin()) link.axis = Vec3::Unit(random.below(3)) * (random.coin() ? 1 : -1);
      if (k + 1 < length && random.coin()) {  // a further axis of the next link's joint
        link.mass = 0;
        link.center_of_mass = Vec3::Zero();
        link.inertia = Mat3::Zero();
        link.armature = 0.1;
      }
      links.push_back(link);
    }
  }
  return FigureModel(links);
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double size = 0, difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    size = std::max(size, std::abs(b[k]));
    difference = std::max(difference, std::abs(a[k] - b[k]));
  }
  return difference / size;
}

TEST(LimbPlan, AgreesWithBodyByBody) {
  RandomFigures random(77);
  double worst = 0, worst_answer = 0;
  int by_limbs = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const FigureModel model = limbed(random, 2 + trial % 7, trial % 2 == 0);
    const Tree tree = build_tree(model);
    by_limbs += LimbPlan(tree, best_instruction_set()).usable();
    FigureDynamics one(model), other(model);
    const Vec3 gravity = random.vector(), base = random.vector();
    for (FigureDynamics* dynamics : {&one, &other}) {
      dynamics->set_gravity(gravity);
      dynamics->set_base_acceleration(base);
    }
    const FigureState state = random.state(model);
    const std::vector<double> tau = random.numbers(model.velocity_count());
    std::vector<double> limbs(tau), bodies(tau);
    const Wrench nothing;  // a load: then it goes body by body
    one.forward(state.q.data(), state.qd.data(), tau.data(), limbs.data());
    other.forward(state.q.data(), state.qd.data(), tau.data(), bodies.data(), {&nothing, 1});
    worst = std::max(worst, apart(limbs, bodies));
    // What hangs on the same walk: loads and torques answered afterwards.
    Wrench load;
    load.link = random.below(model.link_count());
    load.force = random.vector();
    load.moment = random.vector();
    one.respond({&load, 1}, limbs.data());
    other.respond({&load, 1}, bodies.data());
    worst_answer = std::max(worst_answer, apart(limbs, bodies));
    one.forward(state.q.data(), state.qd.data(), nullptr, limbs.data());
    one.respond_to_torques(tau.data(), limbs.data());
    other.respond_to_torques(tau.data(), bodies.data());
    worst_answer = std::max(worst_answer, apart(limbs, bodies));
  }
  std::printf("    %s: %d of 120 by limbs, off by %.1e, answers by %.1e\n", name(best_instruction_set()),
              by_limbs, worst, worst_answer);
  EXPECT_LE(worst, 1e-10);
  EXPECT_LE(worst_answer, 1e-10);
  const int least = best_instruction_set() == InstructionSet::kBaseline ? 0 : 30;
  EXPECT_GE(by_limbs, least);
}

TEST(LimbPlan, TakesTheHumanoidAndLeavesChainsAndBalls) {
  const bool packs = best_instruction_set() != InstructionSet::kBaseline;
  const Tree humanoid = build_tree(read_amdl_file(data_file("mjhum27.amdl")));
  EXPECT_EQ(LimbPlan(humanoid, best_instruction_set()).usable(), packs);
  EXPECT_FALSE(LimbPlan(humanoid, InstructionSet::kBaseline).usable());
  RandomFigures random(1);
  EXPECT_FALSE(LimbPlan(build_tree(limbed(random, 0, true)), best_instruction_set()).usable());
  FigureModel model = limbed(random, 3, true);
  std::vector<Link> links = model.links();
  links.back().joint = JointKind::kBall;
  EXPECT_FALSE(LimbPlan(build_tree(FigureModel(links)), best_instruction_set()).usable());
}

}  // namespace
}  // namespace softpoint::figure
