// The seam in every stock world: what must hold whatever the world, its solver and its configuration.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <gtest/gtest.h>

#include <cmath>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/penetration.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

template <WorldKind kind, bool soft_configuration = false>
struct Stock {
  static constexpr WorldKind kKind = kind;
  static constexpr bool kSoft = soft_configuration;
};

template <class T>
class Worlds : public ::testing::Test {
 protected:
  TestWorld world_{T::kKind, T::kSoft};
};

using Kinds = ::testing::Types<Stock<WorldKind::discrete>, Stock<WorldKind::discrete, true>,
                               Stock<WorldKind::multibody>, Stock<WorldKind::multibody, true>,
                               Stock<WorldKind::soft_rigid>, Stock<WorldKind::soft_multibody>,
                               Stock<WorldKind::deformable>>;

struct KindNames {
  template <class T>
  static std::string GetName(int) {
    const char* names[] = {"Discrete", "MultiBody", "SoftRigid", "SoftMultiBody", "Deformable"};
    return std::string(names[static_cast<int>(T::kKind)]) + (T::kSoft ? "SoftConfiguration" : "");
  }
};

TYPED_TEST_SUITE(Worlds, Kinds, KindNames);

double lowest(const Deformable& body) {
  double y = 1e30;
  for (const Vec3& p : body.points()) y = std::min(y, p.y());
  return y;
}

TYPED_TEST(Worlds, AttachAndDetachLeaveTheWorldAsItWas) {
  TestWorld& world = this->world_;
  btConstraintSolver* solver = world->getConstraintSolver();
  const int objects = world->getNumCollisionObjects();
  {
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube), Vec3(0, 1, 0));
    system.add(body);
    EXPECT_EQ(world->getNumCollisionObjects(), objects + 1);
    world.step(3);
  }
  EXPECT_EQ(world->getConstraintSolver(), solver);
  EXPECT_EQ(world->getNumCollisionObjects(), objects);
  EXPECT_EQ(world.dispatcher().getNumManifolds(), 0);
  // Still a working world.
  world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
  btRigidBody& box = world.add_box(Vec3(0.1, 0.1, 0.1), 1.0, Vec3(0, 0.3, 0));
  world.step(120);
  EXPECT_NEAR(box.getWorldTransform().getOrigin().y(), 0.1, 0.01);
}

TYPED_TEST(Worlds, SecondSystemIsRefusedAndTheFirstGoesOn) {
  TestWorld& world = this->world_;
  DeformableSystem system(*world);
  expect_refusal([&] { DeformableSystem another(*world); }, {"one per world"});
  ElasticBody body(model_of(Shape::cube), Vec3(0, 1, 0));
  system.add(body);
  world.step(2);
  EXPECT_EQ(system.profile().totals.substeps, 2);
  EXPECT_EQ(system.profile().totals.late_substeps, 0);
}

TYPED_TEST(Worlds, AttachesAgainAfterDetaching) {
  TestWorld& world = this->world_;
  ElasticBody body(model_of(Shape::cube), Vec3(0, 1, 0));
  for (int i = 0; i < 3; ++i) {
    DeformableSystem system(*world);
    system.add(body);
    world.step(2);
    EXPECT_EQ(system.profile().totals.late_substeps, 0);
  }
  EXPECT_EQ(body.system(), nullptr);
}

TYPED_TEST(Worlds, FallingBodyFollowsGravity) {
  TestWorld& world = this->world_;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3(0, 10, 0));
  system.add(body);
  const Vec3 start = body.center_of_mass();
  const int steps = 60;
  const double dt = 1.0 / 60.0, g = world->getGravity().y();
  world.step(steps, dt);
  // Symplectic Euler: y = g h^2 n (n + 1) / 2.
  EXPECT_NEAR(body.momentum().y() / body.total_mass(), g * dt * steps, by_precision(1e-12, 1e-5));
  EXPECT_NEAR(body.center_of_mass().y() - start.y(), 0.5 * g * dt * dt * steps * (steps + 1),
              by_precision(1e-12, 1e-5));
  EXPECT_LT(body.elastic_energy(), 1e-12 * body.kinetic_energy());
  EXPECT_EQ(system.profile().totals.late_substeps, 0);
}

TYPED_TEST(Worlds, RestsOnPlaneAndOnBox) {
  for (const bool on_box : {false, true}) {
    TestWorld world(TypeParam::kKind, TypeParam::kSoft);
    if (on_box) {
      world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
    } else {
      world.add_floor();
    }
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube), Vec3(0, 0.25, 0));
    system.add(body);
    world.step(240);
    double speed = 0;
    for (const Vec3& v : body.velocities()) speed = std::max(speed, v.norm());
    EXPECT_LT(speed, 1e-3) << "on box: " << on_box;
    EXPECT_GT(lowest(body), 0.0);
    EXPECT_LT(lowest(body), 2.0 * system.settings().margin);
    EXPECT_EQ(system.profile().totals.late_substeps, 0);
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
  }
}

TYPED_TEST(Worlds, ContactGoesBothWays) {
  TestWorld& world = this->world_;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3::Zero());
  system.add(body);
  btRigidBody& box = world.add_box(Vec3(0.1, 0.1, 0.1), 20.0, Vec3(0, 0.6, 0));
  box.setLinearVelocity(btVector3(0, -3, 0));
  world.step(60);
  EXPECT_GT(box.getLinearVelocity().y(), -2.0);
  EXPECT_LT(body.momentum().y(), -5.0);
  EXPECT_NEAR(body.momentum().y() + 20.0 * box.getLinearVelocity().y(), -60.0, by_precision(1e-9, 1e-3));
}

TYPED_TEST(Worlds, BoxRestsOnBody) {
  TestWorld& world = this->world_;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  btRigidBody& box = world.add_box(Vec3(0.1, 0.1, 0.1), 5.0, Vec3(0, 0.51, 0));
  world.step(300);
  double fastest = 0;
  for (int i = 0; i < 120; ++i) {
    world.step();
    fastest = std::max(fastest, std::abs(double(box.getLinearVelocity().y())));
  }
  EXPECT_LT(fastest, 1e-3);
  EXPECT_NEAR(box.getWorldTransform().getOrigin().y(), 0.5, 0.01);
}

TYPED_TEST(Worlds, SubstepsOfOneCallCountAlike) {
  TestWorld& world = this->world_;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3(0, 10, 0));
  system.add(body);
  const double start = body.center_of_mass().y();
  world->stepSimulation(btScalar(0.1), 10, btScalar(1.0 / 60.0));
  const int substeps = static_cast<int>(system.profile().totals.substeps);
  EXPECT_GE(substeps, 5);
  EXPECT_EQ(system.profile().totals.late_substeps, 0);
  EXPECT_NEAR(body.center_of_mass().y() - start,
              0.5 * world->getGravity().y() / 3600.0 * substeps * (substeps + 1), by_precision(1e-12, 1e-6));
}

TYPED_TEST(Worlds, BodiesAndCollidersMayLeaveInMidContact) {
  TestWorld& world = this->world_;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody staying(model_of(Shape::cube), Vec3(2, 0.25, 0));
  btRigidBody* top = &world.add_box(Vec3(0.1, 0.1, 0.1), 2.0, Vec3(2, 0.6, 0));
  system.add(staying);
  {
    ElasticBody leaving(model_of(Shape::cube), Vec3(0, 0.25, 0));
    system.add(leaving);
    world.step(60);
    EXPECT_FALSE(system.contacts().empty());
    system.remove(leaving);
    EXPECT_EQ(leaving.system(), nullptr);
    for (const ContactPoint& c : system.contacts()) {
      EXPECT_EQ(c.body, &staying);
    }
    world.step(5);
    system.add(leaving);
    const HandleId handle = system.grab(leaving, 3, Vec3(0, 1, 0));
    world.step(5);
    (void)handle;
  }  // destroyed while attached, in contact and held
  EXPECT_EQ(system.bodies().size(), 1u);
  world.step(5);
  world.erase(*top);
  for (const ContactPoint& c : system.contacts()) {
    EXPECT_NE(c.other, top);
  }
  world.step(60);
  EXPECT_GT(lowest(staying), 0.0);
}

TYPED_TEST(Worlds, BodyOutlivesSystem) {
  TestWorld& world = this->world_;
  auto body = std::make_unique<ElasticBody>(model_of(Shape::cube), Vec3(0, 1, 0));
  {
    DeformableSystem system(*world);
    system.add(*body);
    world.step();
  }
  EXPECT_EQ(body->system(), nullptr);
  world.step();
  body.reset();
  world.step();
}

TYPED_TEST(Worlds, HonoursFiltersAndIgnoredPairs) {
  TestWorld& world = this->world_;
  btRigidBody& floor = world.add_floor();
  DeformableSystem system(*world);
  ElasticBody filtered(model_of(Shape::cube), Vec3(0, 0.25, 0)),
      ignoring(model_of(Shape::cube), Vec3(2, 0.25, 0));
  ElasticBody sensor(model_of(Shape::cube), Vec3(4, 0.25, 0)), held(model_of(Shape::cube), Vec3(6, 0.25, 0));
  system.add(filtered, btBroadphaseProxy::DefaultFilter,
             btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
  system.add(ignoring);
  system.add(sensor);
  system.add(held);
  ignoring.setIgnoreCollisionCheck(&floor, true);
  sensor.setCollisionFlags(sensor.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
  world.step(60);
  EXPECT_LT(lowest(filtered), -1.0);
  EXPECT_LT(lowest(ignoring), -1.0);
  EXPECT_LT(lowest(sensor), -1.0);
  EXPECT_GT(lowest(held), 0.0);
  floor.setCollisionFlags(floor.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
  world.step(60);
  EXPECT_LT(lowest(held), -1.0);
}

// A stock soft body beside one of ours behaves as it does without us.
TYPED_TEST(Worlds, StockSoftBodyIsLeftAlone) {
  if (this->world_.soft_info() == nullptr) {
    return;  // this world knows no stock soft bodies
  }
  std::vector<btVector3> seen[2];
  for (const int run : {0, 1}) {
    TestWorld world(TypeParam::kKind);
    world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
    std::unique_ptr<DeformableSystem> system;
    std::unique_ptr<ElasticBody> ours;
    if (run == 1) {
      system = std::make_unique<DeformableSystem>(*world);
      ours = std::make_unique<ElasticBody>(model_of(Shape::cube), Vec3(0.1, 0.9, 0));
      system->add(*ours);  // overlaps the stock body on its way down
    }
    btSoftBodyWorldInfo& info = *world.soft_info();
    btSoftBody* patch =
        btSoftBodyHelpers::CreatePatch(info, btVector3(-0.5, 0.5, -0.5), btVector3(0.5, 0.5, -0.5),
                                       btVector3(-0.5, 0.5, 0.5), btVector3(0.5, 0.5, 0.5), 6, 6, 0, true);
    patch->getCollisionShape()->setMargin(btScalar(0.03));
    if (auto* w = dynamic_cast<btSoftRigidDynamicsWorld*>(&*world)) w->addSoftBody(patch);
    if (auto* w = dynamic_cast<btSoftMultiBodyDynamicsWorld*>(&*world)) w->addSoftBody(patch);
    if (auto* w = dynamic_cast<btDeformableMultiBodyDynamicsWorld*>(&*world)) w->addSoftBody(patch);
    for (int i = 0; i < 60; ++i) {
      world.step();
      seen[run].push_back(patch->m_nodes[17].m_x);
      seen[run].push_back(patch->m_nodes[0].m_x);
    }
    world->removeCollisionObject(patch);
    delete patch;
  }
  for (std::size_t i = 0; i < seen[0].size(); ++i) {
    ASSERT_TRUE(seen[0][i] == seen[1][i])
        << "at " << i << ": " << seen[0][i].y() << " became " << seen[1][i].y();
  }
}

// Functions an app registered with the dispatcher before us are the app's again after us.
TYPED_TEST(Worlds, RegisteredCollisionFunctionsComeBack) {
  struct Counting final : btCollisionAlgorithmCreateFunc {
    btCollisionAlgorithmCreateFunc* inner = nullptr;
    int calls = 0;
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override {
      ++calls;
      return inner->CreateCollisionAlgorithm(info, a, b);
    }
  } counting;
  TestWorld& world = this->world_;
  counting.inner =
      world.configuration().getCollisionAlgorithmCreateFunc(EMPTY_SHAPE_PROXYTYPE, EMPTY_SHAPE_PROXYTYPE);
  world.dispatcher().registerCollisionCreateFunc(SOFTBODY_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE, &counting);
  world.dispatcher().registerCollisionCreateFunc(BOX_SHAPE_PROXYTYPE, SOFTBODY_SHAPE_PROXYTYPE, &counting);
  { DeformableSystem system(*world); }
  // A soft shape that is not ours beside a box.
  btSoftBodyWorldInfo info;
  info.m_broadphase = world->getBroadphase();
  info.m_dispatcher = &world.dispatcher();
  info.m_sparsesdf.Initialize();
  const btVector3 nodes[] = {btVector3(0, 0, 0), btVector3(1, 0, 0), btVector3(0, 0, 1)};
  const btScalar masses[] = {1, 1, 1};
  btSoftBody stock(&info, 3, nodes, masses);
  stock.appendFace(0, 1, 2);
  world->addCollisionObject(&stock, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
  world.add_box(Vec3(0.5, 0.5, 0.5), 0, Vec3::Zero());
  world->performDiscreteCollisionDetection();
  EXPECT_GT(counting.calls, 0);
  world->removeCollisionObject(&stock);
}

TEST(WorldOwnership, WorldThatMadeItsOwnSolverKeepsIt) {
  for (const WorldKind kind : {WorldKind::discrete, WorldKind::soft_rigid}) {
    TestWorld world(kind, false, false);
    btConstraintSolver* solver = world->getConstraintSolver();
    ASSERT_NE(solver, nullptr);
    world.add_floor();
    world.add_box(Vec3(0.1, 0.1, 0.1), 1.0, Vec3(0, 0.1, 0));
    for (int i = 0; i < 2; ++i) {
      DeformableSystem system(*world);
      EXPECT_NE(world->getConstraintSolver(), solver);
      world.step(3);
    }
    EXPECT_EQ(world->getConstraintSolver(), solver);
    world.step(3);
  }
}

TEST(WorldOwnership, DispatcherOfAnotherKindIsRefusedAndNothingChanges) {
  // Only the type of the dispatcher matters here; it is never asked to collide anything.
  struct Foreign final : btDispatcher {
    btCollisionAlgorithm* findAlgorithm(const btCollisionObjectWrapper*, const btCollisionObjectWrapper*,
                                        btPersistentManifold*, ebtDispatcherQueryType) override {
      return nullptr;
    }
    btPersistentManifold* getNewManifold(const btCollisionObject*, const btCollisionObject*) override {
      return nullptr;
    }
    void releaseManifold(btPersistentManifold*) override {}
    void clearManifold(btPersistentManifold*) override {}
    bool needsCollision(const btCollisionObject*, const btCollisionObject*) override { return false; }
    bool needsResponse(const btCollisionObject*, const btCollisionObject*) override { return false; }
    void dispatchAllCollisionPairs(btOverlappingPairCache*, const btDispatcherInfo&, btDispatcher*) override {
    }
    int getNumManifolds() const override { return 0; }
    btPersistentManifold* getManifoldByIndexInternal(int) override { return nullptr; }
    btPersistentManifold** getInternalManifoldPointer() override { return nullptr; }
    btPoolAllocator* getInternalManifoldPool() override { return nullptr; }
    const btPoolAllocator* getInternalManifoldPool() const override { return nullptr; }
    void* allocateCollisionAlgorithm(int) override { return nullptr; }
    void freeCollisionAlgorithm(void*) override {}
  } dispatcher;
  btDbvtBroadphase broadphase;
  btDefaultCollisionConfiguration configuration;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  expect_refusal([&] { DeformableSystem system(world); }, {"dispatcher"});
  EXPECT_EQ(world.getConstraintSolver(), &solver);
}

}  // namespace
}  // namespace softpoint
