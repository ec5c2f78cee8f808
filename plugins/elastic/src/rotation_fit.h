#pragma once

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// exp of a rotation vector.
Mat3 turn_by(const Vec3& rotation_vector);
// The least turn of one direction into another; any one where they are opposite, none where one is nothing.
Mat3 turn_between(const Vec3& from, const Vec3& to);
// Nearest rotation to `a` (polar decomposition), proper also where `a` mirrors.
Mat3 nearest_rotation(const Mat3& a);
// The same from a guess `r`, by Newton's method on tr(R^T a), which mostly takes two or three rounds;
// `inverse` receives (tr(S) 1 - S)^-1, S = sym(R^T a), by which the fit turns when `a` changes:
// pseudo-inverse where points lie on a line or in one place.
void fit_rotation(const Mat3& a, Mat3& r, Mat3& inverse);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
