#include "softpoint/cloth/fabric.h"

#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

void check(const Fabric& fabric, std::string_view name) {
  const std::string at = std::string(name) + ".";
  check_range(at + "area_density", fabric.area_density, kMinAreaDensity, kMaxAreaDensity);
  check_range(at + "warp_stiffness", fabric.warp_stiffness, 0, kMaxSpringStiffness);
  check_range(at + "weft_stiffness", fabric.weft_stiffness, 0, kMaxSpringStiffness);
  check_range(at + "shear_stiffness", fabric.shear_stiffness, 0, kMaxSpringStiffness);
  check_range(at + "bending_stiffness", fabric.bending_stiffness, 0, kMaxBendingStiffness);
  check_range(at + "compression_ratio", fabric.compression_ratio, 0, 1);
  check_range(at + "damping_time", fabric.damping_time, 0, kMaxDampingTime);
  check_range(at + "drag_rate", fabric.drag_rate, 0, kMaxDragRate);
  check_range(at + "thickness", fabric.thickness, 0, 0.1);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
