// Robot descriptions as figures, or refused with the reason.
#include "softpoint/figure/urdf.h"

#include <gtest/gtest.h>

#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

// Two rods on hinges, the second link's frame and inertia turned by a quarter.
std::string pendulum(const std::string& root_inertial = "", const std::string& type = "continuous") {
  const std::string rod =
      "<mass value='1'/><inertia ixx='0.083333333333333329' ixy='0' ixz='0' iyy='0.083333333333333329' "
      "iyz='0' "
      "izz='0.0001'/></inertial>";
  return "<robot name='pendulum'><link name='stand'>" + root_inertial +
         "</link>"
         "<link name='upper'><inertial><origin xyz='0 0 -0.5'/>" +
         rod +
         "</link>"
         "<link name='lower'><inertial><origin xyz='0 0 -0.5' rpy='0 0 1.5707963267948966'/>" +
         rod +
         "</link>"
         "<joint name='shoulder' type='continuous'><parent link='stand'/><child link='upper'/><axis xyz='0 2 "
         "0'/></joint>"
         "<joint name='elbow' type='" +
         type +
         "'><parent link='upper'/><child link='lower'/><origin xyz='0 0 -1' rpy='0 0 1.5707963267948966'/>"
         "<axis xyz='1 0 0'/><limit lower='-0.9' upper='0.4' effort='1' velocity='1'/>"
         "<dynamics damping='0' friction='0'/></joint></robot>";
}

TEST(Urdf, APendulumMovesLikeTheSameInPlainText) {
  if (!has_urdf()) GTEST_SKIP() << "built without liburdfdom";
  const FigureModel model = read_urdf(pendulum(), "pendulum.urdf");
  ASSERT_EQ(model.link_count(), 3);
  EXPECT_EQ(model.links()[0].joint, JointKind::kFixed);
  EXPECT_EQ(model.joint_name(2), "elbow");
  EXPECT_EQ(model.links()[2].name, "lower");
  FigureStepper stepper(model, {{-1.2, -0.5}, {0, 0}});
  FigureStepper expected(read_amdl_file(data_file("pend2.amdl")), {{-1.2, -0.5}, {0, 0}});
  for (int i = 0; i < 200; ++i) {
    stepper.step(0.005);
    expected.step(0.005);
    // The elbow's x axis, turned by a quarter about z, is the parent's y.
    ASSERT_NEAR(stepper.state().q[0], expected.state().q[0], 1e-9);
    ASSERT_NEAR(stepper.state().q[1], expected.state().q[1], 1e-9);
  }
}

TEST(Urdf, RangesBasesAndJointsAreTakenOver) {
  if (!has_urdf()) GTEST_SKIP() << "built without liburdfdom";
  const FigureModel revolute = read_urdf(pendulum("", "revolute"), "a");
  EXPECT_EQ(revolute.links()[2].lower, -0.9);
  EXPECT_EQ(revolute.links()[2].upper, 0.4);
  EXPECT_EQ(read_urdf(pendulum(), "a").links()[2].upper, 1e9);
  EXPECT_EQ(read_urdf(pendulum("", "prismatic"), "a").links()[2].joint, JointKind::kPrismatic);
  EXPECT_EQ(read_urdf(pendulum("", "fixed"), "a").velocity_count(), 1);
  const std::string heavy =
      "<inertial><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
  EXPECT_EQ(read_urdf(pendulum(heavy), "a").links()[0].joint, JointKind::kFree);
  EXPECT_EQ(read_urdf(pendulum(heavy), "a", UrdfBase::kFixed).links()[0].joint, JointKind::kFixed);
  std::string floating = pendulum();
  floating.replace(floating.find("continuous"), 10, "floating");
  EXPECT_EQ(read_urdf(floating, "a").links()[1].joint, JointKind::kFree);
}

// What files made for Bullet hold besides.
TEST(Urdf, SphericalJointsAndShapesForCollisionAreTakenOver) {
  if (!has_urdf()) GTEST_SKIP() << "built without liburdfdom";
  std::string text = pendulum("", "spherical");
  const auto put = [&](const std::string& link, const std::string& geometry) {
    const std::string head = "<link name='" + link + "'>";
    text.insert(text.find(head) + head.size(),
                "<collision><origin xyz='0 0 -0.5' rpy='0 1.5707963267948966 0'/><geometry>" + geometry +
                    "</geometry></collision>");
  };
  put("stand", "<box size='1 0.2 0.3'/>");
  put("upper", "<capsule radius='0.1' length='0.6'/>");
  put("lower", "<cylinder radius='0.1' length='0.6'/>");
  put("lower", "<sphere radius='0.2'/>");
  put("upper", "<mesh filename='none.stl'/>");
  std::vector<LinkCapsule> capsules(7);
  const FigureModel model = read_urdf(text, "a", UrdfBase::kAuto, &capsules);
  EXPECT_EQ(model.links()[2].joint, JointKind::kBall);
  EXPECT_EQ(model.joint_name(2), "elbow");
  ASSERT_EQ(capsules.size(), 4u);
  const auto is = [&](std::size_t k, int link, double half, double radius, const Vec3& along) {
    EXPECT_EQ(capsules[k].link, link);
    EXPECT_NEAR(capsules[k].radius, radius, 1e-12);
    EXPECT_LE((capsules[k].from - (Vec3(0, 0, -0.5) - half * along)).norm(), 1e-12);
    EXPECT_LE((capsules[k].to - (Vec3(0, 0, -0.5) + half * along)).norm(), 1e-12);
  };
  is(0, 0, 0.4, 0.1, -Vec3::UnitZ());  // the box's x is turned downwards
  is(1, 1, 0.3, 0.1, Vec3::UnitX());
  is(2, 2, 0, 0.2, Vec3::UnitX());
  is(3, 2, 0.2, 0.1, Vec3::UnitX());
  expect_refusal([&] { read_urdf("<robot name='x'/>", "a", UrdfBase::kAuto, &capsules); }, {"a"});
  EXPECT_EQ(capsules.size(), 4u);
}

TEST(Urdf, RefusesWithTheReason) {
  if (!has_urdf()) {
    expect_refusal([] { read_urdf(pendulum(), "a.urdf"); }, {"a.urdf", "without liburdfdom"});
    return;
  }
  expect_refusal([] { read_urdf("", "a.urdf"); }, {"a.urdf", "no robot description"});
  expect_refusal([] { read_urdf("<robot name='x'/>", "a.urdf"); }, {"a.urdf"});
  expect_refusal([] { read_urdf(pendulum("", "planar"), "a.urdf"); },
                 {"a.urdf joint 'elbow'", "planar", "permitted"});
  expect_refusal([] { read_urdf(pendulum("", "floating"), "a.urdf"); }, {"joint 'elbow' is floating"});
  std::string hollow = pendulum();
  const std::string mass = "<mass value='1'/>";
  hollow.replace(hollow.rfind(mass), mass.size(), "<mass value='-1'/>");
  expect_refusal([&] { read_urdf(hollow, "a.urdf"); }, {"a.urdf", "'lower' mass = -1"});
  expect_refusal([] { read_urdf_file("nowhere.urdf"); }, {"nowhere.urdf cannot be read"});
}

}  // namespace
}  // namespace softpoint::figure
