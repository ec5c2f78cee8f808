#include "softpoint/elastic/material.h"

#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void check_poisson(std::string_view field, double poisson) {
  check_range(field, poisson, kMinPoisson, kMaxPoisson);
}

void check(const Material& material, std::string_view name) {
  const std::string prefix(name);
  check_range(prefix + ".young", material.young, kMinYoung, kMaxYoung);
  check_poisson(prefix + ".poisson", material.poisson);
  check_range(prefix + ".density", material.density, kMinDensity, kMaxDensity);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
