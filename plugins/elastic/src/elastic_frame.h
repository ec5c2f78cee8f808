#pragma once

#include <vector>

#include "softpoint/elastic/elastic_model.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Best fitting frame of positions about their centre of mass: polar(sum m (x - c) X^T).
Mat3 fit_frame(const ElasticModel& model, const std::vector<Vec3>& positions, const Vec3& center);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
