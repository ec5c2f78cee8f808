#include "scene_material.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

elastic::Material read_material(ObjectReader& item) {
  elastic::Material material;
  item.object("material", "linear, isotropic, homogeneous", [&](ObjectReader& reader) {
    material.young = reader.number("young", {.quantity = Quantity::kPressure,
                                             .low = elastic::kMinYoung,
                                             .high = elastic::kMaxYoung,
                                             .doc = "Young's modulus"});
    material.poisson = reader.number("poisson", {.low = elastic::kMinPoisson,
                                                 .high = elastic::kMaxPoisson,
                                                 .fallback = material.poisson,
                                                 .doc = "Poisson's ratio"});
    material.density = reader.number("density", {.quantity = Quantity::kDensity,
                                                 .low = elastic::kMinDensity,
                                                 .high = elastic::kMaxDensity,
                                                 .fallback = material.density,
                                                 .doc = "mass per volume"});
  });
  return material;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
