// After a first round steps allocate nothing.
#include <gtest/gtest.h>

#include <memory>

#include "controller_room.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_collision.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/counted_heap.h"

namespace softpoint::figure {
namespace {

FigureModel rubbing_humanoid() {
  std::vector<Link> links = read_amdl_file(data_file("mjhum27.amdl")).links();
  for (Link& link : links) {
    if (link.joint != JointKind::kHinge) continue;
    link.friction = 0.2;
    link.damping = 0.05;
  }
  return FigureModel(links);
}

class Swaying final : public PrescribedMotion {
 public:
  void evaluate(double time, double* q, double* qd, double* qdd) const override {
    q[7] = 0.1 * std::sin(time);
    qd[6] = 0.1 * std::cos(time);
    qdd[6] = -0.1 * std::sin(time);
  }
};

TEST(FigureHeap, StepsAllocateNothing) {
  const FigureModel model = rubbing_humanoid();
  for (const Integrator integrator :
       {Integrator::kPaper, Integrator::kRungeKutta4, Integrator::kDormandPrince, Integrator::kVariational}) {
    for (const bool limited : {false, true}) {
      FigureState start = rest_state(model);
      for (int i = 1; i < model.link_count(); ++i) {
        const Link& link = model.links()[static_cast<std::size_t>(i)];
        start.q[static_cast<std::size_t>(model.position_offset(i))] = 0.5 * (link.lower + link.upper);
      }
      RandomFigures random(3);
      for (double& v : start.qd) v = random.vector().x();
      FigureStepper stepper(model, start, integrator);
      if (limited)
        stepper.set_limits(integrator == Integrator::kPaper ? LimitMode::kPaper : LimitMode::kExact);
      const Swaying motion;
      stepper.set_prescribed_motion(&motion);
      const auto flags = std::make_unique<bool[]>(static_cast<std::size_t>(model.link_count()));
      for (int i = 0; i < model.link_count(); ++i) flags[static_cast<std::size_t>(i)] = i != 1;
      stepper.set_dynamic({flags.get(), static_cast<std::size_t>(model.link_count())});
      for (int k = 0; k < 10; ++k) stepper.step(1.0 / 240);
      const long long before = test::heap_calls;
      bool finite = true;
      for (int k = 0; k < 200; ++k) finite = stepper.step(1.0 / 240) && finite;
      const double energy = stepper.energy();
      EXPECT_EQ(test::heap_calls - before, 0) << name(integrator) << " limited " << limited;
      EXPECT_TRUE(finite && std::isfinite(energy));
    }
  }
}

TEST(FigureHeap, StepsWithPinsAndConesAllocateNothing) {
  std::vector<Link> links = read_amdl_file(data_file("chain4ball.amdl")).links();
  for (Link& link : links) {
    link.swing_about = 0.6;
    link.swing_across = 0.22;
    link.lower = -0.2;
    link.upper = 0.3;
  }
  const FigureModel model(links);
  FigureState start = rest_state(model);
  for (std::size_t i = 0; i < start.q.size(); i += 4) {  // slack
    start.q[i] = std::cos(0.1);
    start.q[i + 1] = i % 8 == 0 ? std::sin(0.1) : -std::sin(0.1);
  }
  FigureStepper stepper(model, start);
  stepper.set_limits(LimitMode::kExact);
  const FigureDynamics& placed = stepper.dynamics();
  stepper.dynamics().place(start.q.data(), start.qd.data());
  stepper.set_pins({{model.link_count() - 1, Vec3::Zero(), placed.motion(model.link_count() - 1).position}});
  for (std::size_t i = 0; i < start.qd.size(); ++i) start.qd[i] = i % 2 == 0 ? 1.0 : -3.0;
  stepper.set_state(start);
  for (int k = 0; k < 2; ++k) stepper.step(1.0 / 240);
  const long long before = test::heap_calls;
  for (int k = 0; k < 200; ++k) stepper.step(1.0 / 240);
  EXPECT_EQ(test::heap_calls - before, 0);
  EXPECT_EQ(stepper.guard_fired(), 0);
  EXPECT_GT(stepper.limit_counts().impacts, 3);
}

// A limp doll on a floor and against a box that gives way, in Bullet's own step of the controller.
TEST(FigureHeap, AControllersStepsInContactAllocateNothing) {
  const FigureModel model = doll();
  FigureAnimation animation(model, doll_clip());
  animation.evaluate();
  Room room;
  room.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
  room.box(btVector3(10, 10, 0.5), 0, btVector3(0, 0, -0.5));
  room.box(btVector3(0.2, 0.2, 0.2), 5, btVector3(0, 0.3, 0.2));
  ArticulatedController controller(room.world, animation);
  controller.hand_over(0, true);
  long long calls = 0, contacts = 0;
  for (int k = 0; k < 180; ++k) {
    room.world.stepSimulation(btScalar(1) / 60, 0);
    if (k == 120) contacts = controller.counts().contacts;
    const long long before = test::heap_calls;
    controller.updateAction(&room.world, btScalar(1) / 60);
    if (k > 120) calls += test::heap_calls - before;
  }
  EXPECT_EQ(calls, 0);
  EXPECT_GT(controller.counts().contacts, contacts + 60);
}

TEST(FigureHeap, DynamicsAndCollisionAllocateNothing) {
  const FigureModel model = rubbing_humanoid();
  std::vector<LinkCapsule> capsules;
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    if (link.mass > 0) capsules.push_back({i, {0, 0, 0}, link.center_of_mass, 0.06});
  }
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.size = {1, 1, 1};
  FigureCollision collision(model, capsules, {box, half_space({0, 0, 0}, Vec3::UnitZ())}, {{6, 12}});
  FigureDynamics dynamics(model);
  FigureState state = rest_state(model);
  state.q[2] = 1;
  std::vector<double> qdd(state.qd.size()), change(state.qd.size()), tau(state.qd.size());
  const std::vector<Wrench> loads = {{5, {0, 0, 1}, {1, 0, 0}}};
  std::size_t touches = 0;
  const auto round = [&](int k) {
    state.q[0] = 0.3 * std::sin(0.1 * k);
    dynamics.forward(state.q.data(), state.qd.data(), nullptr, qdd.data(), loads);
    dynamics.respond(loads, change.data());
    dynamics.inverse(state.q.data(), state.qd.data(), qdd.data(), tau.data(), loads);
    dynamics.place(state.q.data(), state.qd.data());
    collision.place(dynamics);
    touches += collision.near(0.1).size();
  };
  for (int k = 0; k < 65; ++k) round(k);
  const long long before = test::heap_calls;
  for (int k = 0; k < 200; ++k) round(k);
  EXPECT_EQ(test::heap_calls - before, 0);
  EXPECT_GT(touches, 100U);
}

}  // namespace
}  // namespace softpoint::figure
