#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/shape_zoo.h"
#include "support/tier.h"

namespace softpoint {

using elastic::ElasticBody;

// One cell of the matrix: a kind of thing in a kind of world. Precision is that of the executable.
struct Cell {
  WorldKind world;
  Zoo kind;
};

inline const char* name_of(WorldKind kind) {
  static const char* const names[] = {"Discrete", "MultiBody", "SoftRigid", "SoftMultiBody", "Deformable"};
  return names[static_cast<int>(kind)];
}
inline std::string name_of(const Cell& cell) { return std::string(name_of(cell.world)) + name_of(cell.kind); }
inline void PrintTo(const Cell& cell, std::ostream* out) { *out << name_of(cell); }

// Every kind that `suits` in the discrete world. In the four others a choice, which holds each way of finding
// contacts once (the plane alone where instrumented), and everything in the long tier.
template <class Predicate>
std::vector<Cell> cells(Predicate suits) {
  std::vector<Cell> all;
  for (int world = 0; world < 5; ++world) {
    for (const Zoo kind : whole_zoo()) {
      const bool chosen =
          kind == Zoo::plane || (!kInstrumented && (kind == Zoo::capsule || kind == Zoo::compound ||
                                                    kind == Zoo::height_field || kind == Zoo::deformable));
      if (suits(kind) && (world == 0 || chosen || full_tier())) {
        all.push_back({static_cast<WorldKind>(world), kind});
      }
    }
  }
  return all;
}

// A world with one thing of the zoo or an elastic slab in it.
struct MatrixScene {
  explicit MatrixScene(WorldKind kind) : world(kind), system(std::make_unique<DeformableSystem>(*world)) {}
  ~MatrixScene() { system.reset(); }
  MatrixScene(const MatrixScene&) = delete;
  MatrixScene& operator=(const MatrixScene&) = delete;

  // The slab, its top at y = 0 and its bottom pinned.
  void put_slab(double young) {
    slab = std::make_unique<ElasticBody>(model_of(Shape::slab, young), Vec3(0, -0.075, 0));
    system->add(*slab);
    for (int v = 0; v < static_cast<int>(slab->points().size()); ++v) {
      const Vec3 p = slab->points()[static_cast<std::size_t>(v)];
      if (p.y() < -0.1499) system->grab(*slab, v, p);
    }
  }
  void put_ground(Zoo kind, Ground look, double young) {
    if (kind == Zoo::deformable) {
      put_slab(young);
    } else {
      thing = zoo.ground(world, kind, look);
    }
  }

  // How deep a body and what is below it are in each other (m).
  double depth(const Deformable& body) const {
    if (&body == slab.get() || slab == nullptr) return thing.depth(body);
    return std::max(skin_in_skin(body, *slab), skin_in_skin(*slab, body));
  }

  // Turns gravity by `angle` (rad) about z, so that what is level becomes a slope down along x.
  void tilt(double angle) {
    world->setGravity(btVector3(btScalar(9.81 * std::sin(angle)), btScalar(-9.81 * std::cos(angle)), 0));
    if (thing.object != nullptr) thing.object->setGravity(world->getGravity());
  }

  ShapeZoo zoo;
  TestWorld world;
  std::unique_ptr<DeformableSystem> system;
  std::unique_ptr<ElasticBody> slab;
  ZooThing thing;
};

// A body turned by `rotation`, straight above what `depth_of(body)` (m) tells the depth in, at `beside` with
// `gap` (m) below it.
template <class DepthOf>
std::unique_ptr<ElasticBody> place_above(DepthOf depth_of, Shape shape, double young, const Vec3& beside,
                                         double gap, const Mat3& rotation, double density) {
  double height = 0.6;
  std::unique_ptr<ElasticBody> body;
  for (int round = 0; round < 60; ++round) {
    body = std::make_unique<ElasticBody>(model_of(shape, young, 1.0 / 60.0, density),
                                         beside + Vec3(0, height, 0), rotation);
    const double clear = -depth_of(*body) - gap;
    if (clear < 1e-5) break;
    height -= std::min(clear, 0.05);
  }
  return body;
}

// The same above the scene's ground.
inline std::unique_ptr<ElasticBody> place_above(const MatrixScene& scene, Shape shape, double young,
                                                const Vec3& beside, double gap, const Mat3& rotation,
                                                double density = 1000.0) {
  return place_above([&](const ElasticBody& body) { return scene.depth(body); }, shape, young, beside, gap,
                     rotation, density);
}

}  // namespace softpoint
