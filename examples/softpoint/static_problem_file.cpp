#include "static_problem_file.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "softpoint/core/obj.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

void read_material(ObjectReader& material, elastic::Material& result, bool& has_density) {
  result.young = material.number("young", {.quantity = Quantity::kPressure,
                                           .low = elastic::kMinYoung,
                                           .high = elastic::kMaxYoung,
                                           .doc = "Young's modulus"});
  result.poisson = material.number(
      "poisson", {.low = elastic::kMinPoisson, .high = elastic::kMaxPoisson, .doc = "Poisson's ratio"});
  const auto density = material.optional_number("density", {.quantity = Quantity::kDensity,
                                                            .low = elastic::kMinDensity,
                                                            .high = elastic::kMaxDensity,
                                                            .doc = "required where gravity is not zero"});
  has_density = density.has_value();
  result.density = density.value_or(result.density);
}

std::string rows(const std::vector<Vec3>& values, std::string_view name) {
  std::string text = "[";
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Vec3& v = values[k];
    check_finite(fmt::format("result {} {}", name, k), v);
    text +=
        fmt::format("{}\n    [{}, {}, {}]", k > 0 ? "," : "", to_text(v.x()), to_text(v.y()), to_text(v.z()));
  }
  return text + "\n  ]";
}

}  // namespace

void read_static_problem(ObjectReader& root, elastic::StaticProblem& problem) {
  const std::filesystem::path mesh =
      root.file("mesh", {.doc = "OBJ file, metres; a closed surface. Polygons count as fans of triangles"});
  if (!root.describing()) {
    try {
      problem.mesh = read_obj(mesh);
      check_closed(problem.mesh, mesh.string());
    } catch (const Error& error) {
      root.refuse("mesh", error.what());
    }
  }
  bool has_density = false;
  root.object("material", "linear, isotropic, homogeneous",
              [&](ObjectReader& material) { read_material(material, problem.material, has_density); });
  root.list("displacement", {.optional = true, .doc = "held vertices"}, [&](ObjectReader& item, int) {
    elastic::HeldVertices held;
    held.vertices =
        item.indices("vertices", {.count = problem.mesh.vertex_count(), .of = "vertices of the mesh"});
    held.value = item.partial_vec3("value", {.quantity = Quantity::kLength,
                                             .low = -kMaxMeshCoordinate,
                                             .high = kMaxMeshCoordinate,
                                             .doc = "displacement; a component that is null is free"});
    problem.displacement.push_back(std::move(held));
  });
  root.list("traction", {.optional = true, .doc = "loaded triangles"}, [&](ObjectReader& item, int) {
    elastic::FaceTraction load;
    load.faces =
        item.indices("faces", {.count = problem.mesh.triangle_count(), .of = "triangles of the mesh"});
    load.value = item.vec3("value", {.quantity = Quantity::kPressure,
                                     .low = -elastic::kMaxTraction,
                                     .high = elastic::kMaxTraction,
                                     .doc = "force per area, uniform"});
    problem.traction.push_back(std::move(load));
  });
  problem.gravity = root.vec3("gravity", {.quantity = Quantity::kAcceleration,
                                          .low = -kMaxAcceleration,
                                          .high = kMaxAcceleration,
                                          .fallback = Vec3(0.0, 0.0, 0.0),
                                          .doc = "in the frame of the mesh"});
  if (!root.describing() && !has_density && !problem.gravity.isZero(0.0)) {
    root.refuse("gravity", "\"density\" is missing in /material; gravity needs it");
  }
}

elastic::StaticProblem read_static_problem(const std::filesystem::path& path) {
  elastic::StaticProblem problem;
  read_json_file(path, [&](ObjectReader& root) { read_static_problem(root, problem); });
  return problem;
}

std::string static_result_json(const elastic::StaticResult& result) {
  check_finite("result energy", result.energy);
  const auto& seconds = result.seconds;
  const std::pair<const char*, double> stages[] = {
      {"quadrature", seconds.stiffness.quadrature},
      {"assembly", seconds.stiffness.assembly},
      {"condensation", seconds.stiffness.condensation},
      {"correction", seconds.stiffness.correction},
      {"solve", seconds.solve},
      {"traction", seconds.traction},
      {"total", seconds.total},
  };
  std::string times;
  for (const auto& [stage, time] : stages) {
    times += fmt::format("{}\n    \"{}\": {}", times.empty() ? "" : ",", stage, to_text(time));
  }
  return fmt::format(
      "{{\n  \"displacement\": {},\n  \"nodal_force\": {},\n  \"traction\": {},\n  \"energy\": {},\n"
      "  \"free_rigid_motions\": {},\n  \"seconds\": {{{}\n  }}\n}}\n",
      rows(result.displacement, "displacement"), rows(result.nodal_force, "nodal_force"),
      rows(result.traction, "traction"), to_text(result.energy), result.free_rigid_motions, times);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
