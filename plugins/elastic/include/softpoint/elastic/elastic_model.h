#pragma once

#include <memory>
#include <vector>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/elastic/boundary_stiffness.h"
#include "softpoint/elastic/material.h"
#include "softpoint/elastic/stiffness_cache.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// How a model is made.
struct ElasticSettings {
  // s, the fixed step of the world (the third argument of stepSimulation), 1e-6 to 1. A body stepped with
  // another one works too, but factors its response anew whenever the step changes.
  double time_step = 1.0 / 60.0;
  StiffnessSettings stiffness;  // accuracy and memory of the assembly
  // The product of each step in single precision, twice as fast for bodies of hundreds of vertices: strains
  // are good to 1e-6 of the largest then. Contact and handles stay in double precision.
  bool single_precision = false;
  CacheSettings cache;  // where the stiffness is kept between runs
};
// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const ElasticSettings& settings);

// What all elastic bodies of one shape, material and time step share. Immutable.
struct ElasticModel {
  TriangleMesh mesh;           // as given
  Material material;           // as given
  double time_step = 0;        // s, of `response`
  double volume = 0;           // m^3
  std::vector<double> masses;  // kg per vertex: density x volume, shared out by surface area
  std::vector<Vec3> rest;      // m, vertices from the centre of mass (X)
  std::vector<Vec3> normals;   // outward unit normals of the rest shape at the vertices
  Vec3 center = Vec3::Zero();  // m, centre of mass in the mesh's frame
  std::shared_ptr<const BoundaryStiffness> stiffness;  // for a Young's modulus of 1 Pa
  std::vector<double> response;                        // (M + h^2 S)^-1, 3V x 3V, m/s per N s
  std::vector<float> single_response;                  // the same, packed, when asked for

  // Degrees of freedom, 3V.
  int dofs() const { return 3 * mesh.vertex_count(); }
};

// Throws Error for a mesh that bounds no solid, settings or material out of range, or a Young's modulus so
// high against density and time step that rounding would drown the masses.
SOFTPOINT_API std::shared_ptr<const ElasticModel> make_elastic_model(const TriangleMesh& mesh,
                                                                     const Material& material,
                                                                     const ElasticSettings& settings = {});

// (M + h^2 S)^-1 for another time step `h` (s), into `response` (3V x 3V).
SOFTPOINT_API void compute_response(const ElasticModel& model, double h, std::vector<double>& response);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
