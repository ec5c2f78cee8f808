#include "mesh_patches.h"

#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include <algorithm>

#include "shape_features.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// A patch is larger than asked for by this part of the region's size on every side.
constexpr double kSurroundings = 0.2;
constexpr long long kMemory = 240;  // substeps an unused patch is kept

struct CollectFacets final : btTriangleCallback {
  void processTriangle(btVector3* corners, int, int) override {
    ShapeFacet facet;
    facet.a = from_bullet(corners[0]);
    facet.b = from_bullet(corners[1]);
    facet.c = from_bullet(corners[2]);
    const Vec3 normal = (facet.b - facet.a).cross(facet.c - facet.a);
    const double twice_area = normal.norm();
    const double longest = std::max({(facet.b - facet.a).squaredNorm(), (facet.c - facet.b).squaredNorm(),
                                     (facet.a - facet.c).squaredNorm()});
    constexpr double kSliver = 1e-9;
    if (!(twice_area > kSliver * longest) || !std::isfinite(twice_area)) {
      return;  // it has no direction; its neighbours cover it
    }
    Bounds box = Bounds::of(facet.a);
    box.include(facet.b);
    box.include(facet.c);
    if (box.misses(region)) {
      return;  // a height field hands out whole cells
    }
    facet.normal = normal / twice_area;
    facet.offset = facet.normal.dot(facet.a);
    facets->push_back(facet);
  }
  std::vector<ShapeFacet>* facets = nullptr;
  Bounds region;
};

}  // namespace

void MeshPatches::begin_substep() {
  ++substep_;
  std::erase_if(entries_, [&](const Entry& entry) { return substep_ - entry.last_used > kMemory; });
}

void MeshPatches::keep(int body) {
  for (Entry& entry : entries_) {
    if (entry.body == body) {
      entry.last_used = substep_;
    }
  }
}

void MeshPatches::forget(const btCollisionShape& shape) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.shape == &shape; });
}

void MeshPatches::forget_body(int body) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.body == body; });
  for (Entry& entry : entries_) {
    entry.body -= entry.body > body;
  }
}

const ColliderShape& MeshPatches::get(int body, const btCollisionObject& object, int child,
                                      const btConcaveShape& shape, const Bounds& region, bool& fresh) {
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.body == body && entry.object == &object && entry.child == child && entry.shape == &shape;
  });
  Entry& entry = known != entries_.end() ? *known : entries_.emplace_back();
  entry.last_used = substep_;
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const Vec3 scaling = from_bullet(shape.getLocalScaling());
  const Vec3 bounds_low = from_bullet(low), bounds_high = from_bullet(high);
  fresh = entry.patch == nullptr || entry.scaling != scaling || entry.bounds_low != bounds_low ||
          entry.bounds_high != bounds_high || !entry.region.contains(region);
  if (!fresh) {
    return *entry.patch;
  }
  entry.body = body;
  entry.object = &object;
  entry.child = child;
  entry.shape = &shape;
  entry.scaling = scaling;
  entry.bounds_low = bounds_low;
  entry.bounds_high = bounds_high;
  entry.region = region.grown(kSurroundings * (region.high - region.low).maxCoeff());
  if (entry.patch == nullptr) {
    entry.patch = std::make_unique<ColliderShape>();
  }
  ColliderShape& patch = *entry.patch;
  patch.kind = ColliderShape::Kind::mesh;
  patch.facets.clear();
  patch.corners.clear();
  patch.corner_edges.clear();
  patch.corner_edges_from.clear();
  patch.edges.clear();
  patch.thinnest = std::numeric_limits<double>::infinity();
  patch.bounds_min = entry.region.low;
  patch.bounds_max = entry.region.high;
  CollectFacets collect;
  collect.facets = &patch.facets;
  collect.region = entry.region;
  shape.processAllTriangles(&collect, to_bullet(entry.region.low), to_bullet(entry.region.high));
  sheets_.align(patch.facets);
  add_facet_features(patch, work_);
  return patch;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
