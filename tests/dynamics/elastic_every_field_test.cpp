// Every number of materials, settings, problems and bodies, tried with NaN, infinities, negative, zero and
// huge values.
#include <gtest/gtest.h>

#include "softpoint/core/deformable_system.h"
#include "softpoint/core/limits.h"
#include "softpoint/core/shapes.h"
#include "softpoint/elastic/elastic_body.h"
#include "softpoint/elastic/statics.h"
#include "support/field_table.h"
#include "support/refusal.h"
#include "support/worlds.h"

namespace softpoint::elastic {
namespace {

TriangleMesh small_cube() { return box_grid(1, 1, 1, Vec3(0.4, 0.4, 0.4)); }

ElasticSettings without_cache() {
  ElasticSettings settings;
  settings.cache.folder.clear();
  return settings;
}

std::shared_ptr<const ElasticModel> model() {
  static const auto made = make_elastic_model(small_cube(), {}, without_cache());
  return made;
}

// The body falls on a floor and is pushed.
bool lives_finitely(std::shared_ptr<const ElasticModel> made, const Vec3& origin = Vec3(0, 0.21, 0),
                    const Vec3& linear = Vec3::Zero(), const Vec3& angular = Vec3::Zero()) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(std::move(made), origin);
  body.set_velocity(linear, angular);
  system.add(body);
  world.step(10);
  return all_finite(body.points()) && all_finite(body.velocities()) && std::isfinite(body.elastic_energy()) &&
         system.profile().totals.guard_fired == 0;
}

Fields fields_of(Material& material) {
  auto& [young, poisson, density] = material;
  return {{"young", young, kMinYoung, kMaxYoung},
          {"poisson", poisson, kMinPoisson, kMaxPoisson},
          {"density", density, kMinDensity, kMaxDensity}};
}

Fields fields_of(Quadrature& quadrature) {
  auto& [far_points, near_points, near_graded_order, near_distance] = quadrature;
  return {{"far_points", far_points, 1, 0, {0, 1, 3, 6, 12}},
          {"near_points", near_points, 1, 0, {0, 3, 6, 12}},
          {"near_graded_order", near_graded_order, 2, 16, {0}},
          {"near_distance", near_distance, 1, 10}};
}

static_assert(sizeof(InstructionSet) == sizeof(int));

Fields fields_of(StiffnessSettings& settings) {
  auto& [quadrature, keep_traction, max_instruction_set, memory_limit] = settings;
  static_assert(std::is_same_v<decltype(keep_traction), bool>);
  static_assert(std::is_same_v<decltype(max_instruction_set), InstructionSet>);           // tried below
  Fields fields{{"memory_limit", memory_limit, stiffness_memory(8, 12), kLargest, {0}}};  // of the cube
  add_fields(fields, fields_of(quadrature));
  return fields;
}

Fields fields_of(CacheSettings& settings) {
  auto& [folder, capacity] = settings;
  static_assert(std::is_same_v<decltype(folder), std::string>);  // stiffness_cache_test.cpp
  return {{"capacity", capacity, 0, kLargest}};
}

Fields fields_of(ElasticSettings& settings) {
  auto& [time_step, stiffness, single_precision, cache] = settings;
  static_cast<void>(single_precision);  // both are permitted
  Fields fields{{"time_step", time_step, 1e-6, 1.0}};
  add_fields(fields, fields_of(stiffness));
  add_fields(fields, fields_of(cache));
  return fields;
}

TEST(EveryField, OfAMaterial) {
  expect_every_field<Material>(
      {}, [](Material& s) { return fields_of(s); },
      [](const Material& material) {
        return lives_finitely(make_elastic_model(small_cube(), material, without_cache()));
      });
}

TEST(EveryField, OfElasticSettings) {
  expect_every_field<ElasticSettings>(
      without_cache(), [](ElasticSettings& s) { return fields_of(s); },
      [](const ElasticSettings& settings) {
        return lives_finitely(make_elastic_model(small_cube(), {}, settings));
      });
}

TEST(EveryField, AnInstructionSetIsOneOfTheNamedOnes) {
  for (const int bad : {-1, 3, 1000}) {
    ElasticSettings settings = without_cache();
    settings.stiffness.max_instruction_set = static_cast<InstructionSet>(bad);
    expect_refusal([&] { make_elastic_model(small_cube(), {}, settings); },
                   {"max_instruction_set = " + std::to_string(bad), "permitted is 0 to 2"});
  }
}

TEST(EveryField, AFolderWithAZeroByteIsRefused) {
  ElasticSettings settings;
  settings.cache.folder = std::string("a\0b", 3);
  expect_refusal([&] { make_elastic_model(small_cube(), {}, settings); }, {"cache.folder", "permitted"});
}

// Stiff against its masses beyond what doubles can tell apart.
TEST(EveryField, AModulusThatDrownsTheMassesIsRefusedWithTheLargestThatDoesNot) {
  ElasticSettings settings = without_cache();
  settings.time_step = 1.0;
  const Material material{.young = 1e15, .poisson = 0.3, .density = 1e-6};
  const std::string message = refusal([&] { make_elastic_model(small_cube(), material, settings); });
  EXPECT_NE(message.find("young = 1e+15: permitted is up to "), std::string::npos) << message;
  const double largest = std::stod(message.substr(message.find("up to ") + 6));
  EXPECT_TRUE(lives_finitely(make_elastic_model(small_cube(), {0.99 * largest, 0.3, 1e-6}, settings)));
}

TEST(EveryField, OfTheMeshOfABody) {
  expect_every_field<TriangleMesh>(
      small_cube(),
      [](TriangleMesh& mesh) {
        auto& [vertices, triangles] = mesh;
        Fields fields;
        for (Vec3& v : vertices) add_fields(fields, "vertex", v, -kMaxMeshCoordinate, kMaxMeshCoordinate);
        for (Triangle& t : triangles) {
          for (int& v : t) fields.emplace_back("vertex", v, 0, 7);
        }
        return fields;
      },
      [](const TriangleMesh& mesh) { return lives_finitely(make_elastic_model(mesh, {}, without_cache())); },
      [] { return std::string(); }, Range::necessary);
}

TEST(EveryField, OfPlaceAndMotion) {
  struct Start {
    Vec3 origin{0, 0.21, 0}, linear{0, 0, 0}, angular{0, 0, 0};
  };
  expect_every_field<Start>(
      {},
      [](Start& start) {
        Fields fields;
        // The cube's corners lie 0.2 m farther out, so the last of the range goes to them.
        add_fields(fields, "origin", start.origin, -kMaxPosition, kMaxPosition);
        add_fields(fields, "linear", start.linear, -kMaxSpeed, kMaxSpeed);
        add_fields(fields, "angular", start.angular, -kMaxSpin, kMaxSpin);
        return fields;
      },
      [](const Start& start) {
        Vec3 origin = start.origin;
        for (int k = 0; k < 3; ++k) {
          if (std::abs(origin[k]) == kMaxPosition) origin[k] *= 1.0 - 1e-6;
        }
        return lives_finitely(model(), origin, start.linear, start.angular);
      });
}

TEST(EveryField, OfARotation) {
  for (int entry = 0; entry < 9; ++entry) {
    for (const double value : {kNotANumber, kUnbounded, -kUnbounded, -1.0, 2.0, 1e300}) {
      Mat3 rotation = Mat3::Identity();
      rotation(entry / 3, entry % 3) = value;
      expect_refusal([&] { ElasticBody(model(), Vec3::Zero(), rotation); },
                     {"rotation", "permitted is 0 to"});
    }
  }
}

// A refused velocity leaves the body as it moves.
TEST(EveryField, RefusedVelocitiesChangeNothing) {
  ElasticBody body(model());
  body.set_velocity(Vec3(1, 2, 3), Vec3(0, 1, 0));
  const std::vector<Vec3> before(body.velocities().begin(), body.velocities().end());
  EXPECT_THROW(body.set_velocity(Vec3(kNotANumber, 0, 0)), Error);
  EXPECT_THROW(body.set_velocity(Vec3(5, 5, 5), Vec3(0, 0, kUnbounded)), Error);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), body.velocities().begin()));
}

// One end held, the other pulled, under gravity.
StaticProblem problem() {
  StaticProblem p;
  p.mesh = small_cube();
  HeldVertices held;
  FaceTraction pulled;
  for (int v = 0; v < p.mesh.vertex_count(); ++v) {
    if (p.mesh.vertices[static_cast<std::size_t>(v)].x() < 0) held.vertices.push_back(v);
  }
  for (int f = 0; f < p.mesh.triangle_count(); ++f) {
    if (triangle_normal(p.mesh, f).x() > 0.9) pulled.faces.push_back(f);
  }
  held.value = {0.0, 0.0, 0.0};
  pulled.value = {1000, 0, 0};
  p.displacement = {held};
  p.traction = {pulled};
  p.gravity = {0, -9.81, 0};
  return p;
}

Fields fields_of(StaticProblem& given) {
  auto& [mesh, material, displacement, traction, gravity] = given;
  static_assert(std::is_same_v<decltype(mesh), TriangleMesh>);  // OfTheMeshOfABody
  Fields fields = fields_of(material);
  auto& [vertices, value] = displacement[0];
  for (int& v : vertices) fields.emplace_back("vertices", v, 0, 7);
  for (auto& component : value)
    fields.emplace_back("value", *component, -kMaxMeshCoordinate, kMaxMeshCoordinate);
  auto& [faces, pull] = traction[0];
  for (int& f : faces) fields.emplace_back("faces", f, 0, 11);
  add_fields(fields, "value", pull, -kMaxTraction, kMaxTraction);
  add_fields(fields, "gravity", gravity, -kMaxAcceleration, kMaxAcceleration);
  return fields;
}

TEST(EveryField, OfAStaticProblem) {
  expect_every_field<StaticProblem>(
      problem(), [](StaticProblem& s) { return fields_of(s); },
      [](const StaticProblem& given) {
        const StaticResult result = solve_statics(given);
        return all_finite(result.displacement) && all_finite(result.nodal_force) &&
               all_finite(result.traction) && std::isfinite(result.energy);
      });
}

}  // namespace
}  // namespace softpoint::elastic
