// Every number that core takes from outside, tried with NaN, infinities, negative, zero and huge values.
#include <gtest/gtest.h>

#include <cstring>

#include "softpoint/core/deformable_system.h"
#include "softpoint/core/limits.h"
#include "softpoint/core/shapes.h"
#include "support/field_table.h"
#include "support/particles.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

std::string bits(std::span<const Vec3> values) {
  std::string text(values.size_bytes(), '\0');
  std::memcpy(text.data(), values.data(), values.size_bytes());
  return text;
}

// A body over a floor, held by one handle.
struct Seam {
  explicit Seam(const ContactSettings& settings = {}) : system(*world, settings) {
    world.add_floor();
    system.add(body);
    handle = system.grab(body, 0, body.points()[0], 5.0);
  }

  bool steps_finitely(int count = 10) {
    world.step(count);
    return all_finite(body.points()) && all_finite(body.velocities());
  }

  std::string state() {
    const Vec3 force = system.handle_force(handle);
    const ContactSettings& s = system.settings();
    return bits(body.points()) + bits(body.velocities()) + bits({&force, 1}) + to_text(s.margin) +
           to_text(s.tolerance) + to_text(s.max_iterations) + to_text(s.max_passes) +
           to_text(s.rebound_speed) + to_text(s.rigid_support) + to_text(world->getNumCollisionObjects());
  }

  // What the next steps make of it: queued impulses, handles, accelerations all show here.
  std::string future() {
    world.step(3);
    return state();
  }

  TestWorld world;
  Particles body = Particles::tetrahedron(Vec3(0, 0.3, 0));
  DeformableSystem system;
  HandleId handle = 0;
};

Fields fields_of(ContactSettings& settings) {
  auto& [margin, tolerance, max_iterations, max_passes, rebound_speed, rigid_support] = settings;
  static_assert(std::is_same_v<decltype(rigid_support), bool>);
  return {{"margin", margin, 1e-5, 0.1},
          {"tolerance", tolerance, 1e-12, 1e-2},
          {"max_iterations", max_iterations, 1, 10000},
          {"max_passes", max_passes, 1, 20},
          {"rebound_speed", rebound_speed, 0, 1e6}};
}

TEST(EveryField, OfContactSettingsAtConstruction) {
  TestWorld world;
  expect_every_field<ContactSettings>({}, fields_of,
                                      [](const ContactSettings& s) { return Seam(s).steps_finitely(60); });
  // A system that is refused leaves the world as it was.
  btConstraintSolver* solver = world->getConstraintSolver();
  ContactSettings bad;
  bad.margin = kNotANumber;
  EXPECT_THROW(DeformableSystem(*world, bad), Error);
  EXPECT_EQ(world->getConstraintSolver(), solver);
  world.step(3);
}

TEST(EveryField, OfContactSettingsOfARunningSystem) {
  Seam seam;
  seam.world.step(5);
  expect_every_field<ContactSettings>(
      {}, fields_of,
      [&](const ContactSettings& s) {
        seam.system.set_settings(s);
        return seam.steps_finitely();
      },
      [&] { return seam.state(); });
}

// Calls that take numbers while a system runs. A refused call has no effect, now or in the steps to come.
template <class Arguments>
void expect_every_argument(const Arguments& valid,
                           const std::function<Fields(Arguments&)>& fields_of_arguments,
                           const std::function<void(Seam&, const Arguments&)>& call) {
  expect_every_field<Arguments>(valid, fields_of_arguments, [&](const Arguments& arguments) {
    Seam seam;
    Seam untouched;
    seam.world.step(2);
    untouched.world.step(2);
    try {
      call(seam, arguments);
    } catch (const Error&) {
      EXPECT_EQ(seam.future(), untouched.future()) << "the refused call had an effect";
      throw;
    }
    return seam.steps_finitely();
  });
}

TEST(EveryField, OfGrab) {
  struct Grab {
    int point = 1;
    Vec3 target{0.1, 0.4, 0};
    double max_force = 10;
  };
  expect_every_argument<Grab>(
      {},
      [](Grab& g) {
        Fields fields{
            {"point", g.point, 0, 3},
            {"max_force", g.max_force, std::numeric_limits<double>::denorm_min(), kLargest, {kUnbounded}}};
        add_fields(fields, "target", g.target, -kMaxPosition, kMaxPosition);
        return fields;
      },
      [](Seam& seam, const Grab& g) { seam.system.grab(seam.body, g.point, g.target, g.max_force); });
}

TEST(EveryField, OfAttach) {
  struct Attach {
    int point = 1;
    Vec3 local{0.1, 0.4, 0};
    double max_force = 10;
  };
  expect_every_argument<Attach>(
      {},
      [](Attach& a) {
        Fields fields{
            {"point", a.point, 0, 3},
            {"max_force", a.max_force, std::numeric_limits<double>::denorm_min(), kLargest, {kUnbounded}}};
        add_fields(fields, "local", a.local, -kMaxPosition, kMaxPosition);
        return fields;
      },
      [](Seam& seam, const Attach& a) {
        const btCollisionObject& floor = *seam.world->getCollisionObjectArray()[0];
        seam.system.attach(seam.body, a.point, floor, a.local, a.max_force);
      });
}

TEST(EveryField, OfMove) {
  expect_every_argument<Vec3>(
      Vec3(0.1, 0.5, 0),
      [](Vec3& target) {
        Fields fields;
        add_fields(fields, "target", target, -kMaxPosition, kMaxPosition);
        return fields;
      },
      [](Seam& seam, const Vec3& target) { seam.system.move(seam.handle, target); });
}

TEST(EveryField, OfImpulses) {
  struct Impulse {
    int face = 2;
    Vec3 impulse{0, 0.1, 0};
  };
  expect_every_argument<Impulse>(
      {},
      [](Impulse& i) {
        Fields fields{{"face", i.face, 0, 3}};
        add_fields(fields, "impulse", i.impulse, -kMaxImpulse, kMaxImpulse);
        return fields;
      },
      [](Seam& seam, const Impulse& i) { seam.body.apply_impulse(i.face, Vec3(0.2, 0.3, 0.5), i.impulse); });
  // Weights: one tried, the others keep the sum at 1 where they can.
  expect_every_argument<double>(
      0.25,
      [](double& weight) {
        return Fields{{"weights", weight, -1e-6, 1.0 + 1e-6}};
      },
      [](Seam& seam, const double& weight) {
        const double rest = weight >= -1e-6 && weight <= 1.0 ? 1.0 - weight : 0.0;
        seam.body.apply_impulse(0, Vec3(weight, rest, 0), Vec3(0, 0.1, 0));
      });
}

TEST(EveryField, OfAccelerations) {
  expect_every_argument<Vec3>(
      Vec3(0, 1, 0),
      [](Vec3& acceleration) {
        Fields fields;
        add_fields(fields, "acceleration", acceleration, -kMaxAcceleration, kMaxAcceleration);
        return fields;
      },
      [](Seam& seam, const Vec3& acceleration) { seam.body.set_acceleration(acceleration); });
}

TEST(EveryField, OfRays) {
  struct Ray {
    Vec3 from{0, 5, 0}, to{0, -5, 0};
  };
  expect_every_argument<Ray>(
      {},
      [](Ray& ray) {
        Fields fields;
        add_fields(fields, "from", ray.from, -kMaxRay, kMaxRay);
        add_fields(fields, "to", ray.to, -kMaxRay, kMaxRay);
        return fields;
      },
      [](Seam& seam, const Ray& ray) {
        const auto hit = seam.system.pick(ray.from, ray.to);
        EXPECT_TRUE(!hit || (hit->position.allFinite() && hit->weights.allFinite()));
      });
}

TEST(EveryField, OfTheBodyOfADeformable) {
  struct Body {
    std::vector<Vec3> points{{0, 0.2, 0}, {1, 0.2, 0}, {0, 0.2, 1}};
    Triangle face{0, 2, 1};
    double mass = 1;
  };
  expect_every_field<Body>(
      {},
      [](Body& body) {
        Fields fields{{"mass of point", body.mass, kMinPointMass, kMaxPointMass}};
        for (Vec3& point : body.points)
          add_fields(fields, "position of point", point, -kMaxPosition, kMaxPosition);
        for (int& v : body.face) fields.emplace_back("vertex of a face", v, 0, 2);
        return fields;
      },
      [](const Body& given) {
        TestWorld world;
        world.add_floor();
        DeformableSystem system(*world);
        Particles body(given.points, {given.face}, given.mass);
        system.add(body);
        world.step(10);
        return all_finite(body.points());
      });
}

Fields fields_of(TriangleMesh& mesh) {
  auto& [vertices, triangles] = mesh;
  Fields fields;
  for (Vec3& vertex : vertices) add_fields(fields, "vertex", vertex, -kMaxMeshCoordinate, kMaxMeshCoordinate);
  for (Triangle& triangle : triangles) {
    for (int& v : triangle) fields.emplace_back("vertex", v, 0, static_cast<int>(vertices.size()) - 1);
  }
  return fields;
}

// Numbers within the range may still spoil the shape; then the refusal says how, and what to do.
TEST(EveryField, OfAMesh) {
  for (const auto& check_mesh : {+[](const TriangleMesh& m) { return check_closed(m); },
                                 +[](const TriangleMesh& m) { return check_surface(m); }}) {
    expect_every_field<TriangleMesh>(
        box_grid(1, 1, 1, Vec3(1, 1, 1)), [](TriangleMesh& mesh) { return fields_of(mesh); },
        [&](const TriangleMesh& mesh) {
          const MeshReport report = check_mesh(mesh);
          return std::isfinite(report.volume) && std::isfinite(report.area);
        },
        [] { return std::string(); }, Range::necessary);
  }
}

bool is_finite_mesh(const TriangleMesh& mesh) {
  return all_finite(mesh.vertices) && std::isfinite(surface_area(mesh)) && std::isfinite(signed_volume(mesh));
}

TEST(EveryField, OfTheShapeGenerators) {
  constexpr double kLow = kMinMeshSize, kHigh = kMaxMeshCoordinate;
  struct Counts {
    int a = 3, b = 2, c = 2;
    Vec3 size{1, 0.5, 0.3};
  };
  const auto counts = [](const char* a, int low_a, const char* b, int low_b, const char* c, int low_c) {
    return [=](Counts& n) {
      // The largest counts are within their ranges one by one; together they may make too many vertices.
      Fields fields{{a, n.a, double(low_a), 4096}};
      if (b != nullptr) fields.push_back({b, n.b, double(low_b), 4096});
      if (c != nullptr) fields.push_back({c, n.c, double(low_c), 4096});
      return fields;
    };
  };
  const auto lengths = [=](std::vector<const char*> names) {
    return [=](Counts& n) {
      Fields fields;
      for (std::size_t k = 0; k < names.size(); ++k) {
        fields.emplace_back(names[k], n.size[static_cast<Eigen::Index>(k)], kLow, kHigh);
      }
      return fields;
    };
  };
  using Make = std::function<TriangleMesh(const Counts&)>;
  const auto expect = [](const std::function<Fields(Counts&)>& fields, const Make& make,
                         Range range = Range::sufficient) {
    expect_every_field<Counts>(
        {}, fields, [&](const Counts& n) { return is_finite_mesh(make(n)); }, [] { return std::string(); },
        range);
  };
  const Make make_prism = [](const Counts& n) { return prism(n.a, n.b, n.c, n.size[0], n.size[1]); };
  expect(counts("prism sides", 3, "prism stacks", 1, "prism cap_rings", 1), make_prism);
  expect(lengths({"prism radius", "prism length"}), make_prism);
  const Make make_box = [](const Counts& n) { return box_grid(n.a, n.b, n.c, n.size); };
  expect(counts("box_grid nx", 1, "box_grid ny", 1, "box_grid nz", 1), make_box);
  expect(lengths({"box_grid size x", "box_grid size y", "box_grid size z"}), make_box);
  const Make make_grid = [](const Counts& n) { return square_grid(n.a, n.b, n.size[0], n.size[1]); };
  expect(counts("square_grid nx", 1, "square_grid ny", 1, nullptr, 0), make_grid);
  expect(lengths({"square_grid width", "square_grid height"}), make_grid);
  expect(lengths({"sphere radius"}), [](const Counts& n) { return sphere(n.size[0], 1); });
  expect(
      [](Counts& n) {
        return Fields{{"sphere subdivisions", n.a, 0, 8}};
      },
      [](const Counts& n) { return sphere(1.0, n.a > 6 && n.a <= 8 ? 6 : n.a); });
  const Make make_uv = [](const Counts& n) { return uv_sphere(n.size[0], n.a, n.b); };
  expect(counts("uv_sphere sectors", 3, "uv_sphere rings", 1, nullptr, 0), make_uv);
  expect(lengths({"uv_sphere radius"}), make_uv);
  const Make make_capsule = [](const Counts& n) { return capsule(n.size[0], n.size[1], n.a, n.b, n.c); };
  expect(counts("capsule sectors", 3, "capsule stacks", 1, "capsule rings", 1), make_capsule);
  expect(lengths({"capsule radius", "capsule length"}), make_capsule);
  // One must be smaller than the other, too.
  expect(
      lengths({"hollow_sphere outer_radius", "hollow_sphere inner_radius"}),
      [](const Counts& n) { return hollow_sphere(n.size[0], n.size[1], 1); }, Range::necessary);
  expect(
      [](Counts& n) {
        return Fields{{"hollow_sphere subdivisions", n.a, 0, 8}};
      },
      [](const Counts& n) { return hollow_sphere(1, 0.5, n.a > 5 && n.a <= 8 ? 5 : n.a); });
}

}  // namespace
}  // namespace softpoint
