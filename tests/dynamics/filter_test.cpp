// What the application forbids to collide does not: for rigid bodies, links of multibodies, and objects that
// a body meets only because it moves farther than the broadphase knew.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/multibodies.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

enum class Way {
  none,
  group_of_body,
  mask_of_body,
  group_and_mask_of_object,
  ignore_by_body,
  ignore_by_object,
  no_response_of_body,
  no_response_of_object,
  callback
};
enum class Obstacle { rigid, link, ahead };

// Bullet's callback of the pair cache, as applications use it.
struct Forbid final : btOverlapFilterCallback {
  const btCollisionObject* a = nullptr;
  const btCollisionObject* b = nullptr;
  bool needBroadphaseCollision(btBroadphaseProxy* p, btBroadphaseProxy* q) const override {
    return !((p->m_clientObject == a && q->m_clientObject == b) ||
             (p->m_clientObject == b && q->m_clientObject == a));
  }
};

class Filter : public ::testing::TestWithParam<std::tuple<WorldKind, Obstacle, Way>> {};

std::string filter_name(const ::testing::TestParamInfo<Filter::ParamType>& info) {
  const char* worlds[] = {"Discrete", "MultiBody", "SoftRigid", "SoftMultiBody", "Deformable"};
  const char* obstacles[] = {"Rigid", "Link", "Ahead"};
  const char* ways[] = {"None",         "GroupOfBody",    "MaskOfBody",       "GroupAndMaskOfObject",
                        "IgnoreByBody", "IgnoreByObject", "NoResponseOfBody", "NoResponseOfObject",
                        "Callback"};
  return std::string(worlds[static_cast<int>(std::get<0>(info.param))]) +
         obstacles[static_cast<int>(std::get<1>(info.param))] +
         ways[static_cast<int>(std::get<2>(info.param))];
}

const std::vector<Way> kEveryWay = {
    Way::none,           Way::group_of_body,    Way::mask_of_body,        Way::group_and_mask_of_object,
    Way::ignore_by_body, Way::ignore_by_object, Way::no_response_of_body, Way::no_response_of_object,
    Way::callback};
// btMultiBodyLinkCollider does not ask its own list of ignored objects.
const std::vector<Way> kWaysOfLinks = {
    Way::none,           Way::group_of_body,       Way::mask_of_body,          Way::group_and_mask_of_object,
    Way::ignore_by_body, Way::no_response_of_body, Way::no_response_of_object, Way::callback};

INSTANTIATE_TEST_SUITE_P(
    Rigid, Filter,
    ::testing::Combine(::testing::Values(WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                                         WorldKind::soft_multibody, WorldKind::deformable),
                       ::testing::Values(Obstacle::rigid, Obstacle::ahead), ::testing::ValuesIn(kEveryWay)),
    filter_name);
INSTANTIATE_TEST_SUITE_P(Links, Filter,
                         ::testing::Combine(::testing::Values(WorldKind::multibody, WorldKind::soft_multibody,
                                                              WorldKind::deformable),
                                            ::testing::Values(Obstacle::link),
                                            ::testing::ValuesIn(kWaysOfLinks)),
                         filter_name);

TEST_P(Filter, ForbidsAContact) {
  const auto [kind, obstacle, way] = GetParam();
  constexpr int kOurs = 64, kTheirs = 128;
  TestWorld world(kind);
  world->setGravity(btVector3(0, 0, 0));
  std::unique_ptr<Multibodies> multibodies;
  btCollisionObject* object = nullptr;
  if (obstacle == Obstacle::link) {
    multibodies = std::make_unique<Multibodies>(world);
    object = multibodies->add_chain({.links = 1, .base = Vec3(-0.42, 0, 0)}).getLinkCollider(0);
  } else {
    object = &world.add_box(Vec3(0.3, 0.05, 0.3), 0, Vec3::Zero());
  }
  btBroadphaseProxy* proxy = object->getBroadphaseHandle();
  proxy->m_collisionFilterGroup = kTheirs;
  proxy->m_collisionFilterMask = way == Way::group_and_mask_of_object ? ~kOurs : -1;
  DeformableSystem system(*world);
  const bool ahead = obstacle == Obstacle::ahead;
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, ahead ? 1.5 : 0.27, 0));
  Forbid forbid;
  forbid.a = &body;
  forbid.b = object;
  if (way == Way::callback) world->getPairCache()->setOverlapFilterCallback(&forbid);
  system.add(body, way == Way::group_of_body ? 256 : kOurs, way == Way::mask_of_body ? ~kTheirs : -1);
  if (way == Way::group_of_body) proxy->m_collisionFilterMask = kOurs;
  const auto switch_off = [](btCollisionObject& o) {
    o.setCollisionFlags(o.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
  };
  if (way == Way::ignore_by_body) body.setIgnoreCollisionCheck(object, true);
  if (way == Way::ignore_by_object) object->setIgnoreCollisionCheck(&body, true);
  if (way == Way::no_response_of_body) switch_off(body);
  if (way == Way::no_response_of_object) switch_off(*object);
  std::vector<HandleId> handles;
  if (ahead) {
    // All points are carried through the object within one step, from where no pair is near.
    world.step(2);
    for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
      const Vec3& p = body.points()[static_cast<std::size_t>(v)];
      handles.push_back(system.grab(body, v, p - Vec3(0, 1.25, 0), 5e6));
    }
  } else {
    body.set_velocity(Vec3(0, -3, 0), Vec3::Zero());
  }
  bool touched = false;
  for (int i = 0; i < (ahead ? 1 : 6); ++i) {
    world.step();
    for (const ContactPoint& c : system.contacts()) touched |= c.other == object;
  }
  if (ahead) {
    EXPECT_GT(system.profile().counts.swept_queries, 0);
  }
  EXPECT_EQ(touched, way == Way::none);
  world->getPairCache()->setOverlapFilterCallback(nullptr);
}

}  // namespace
}  // namespace softpoint
