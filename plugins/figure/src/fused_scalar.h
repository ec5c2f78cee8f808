#pragma once

#include "softpoint/core/config.h"

// A double whose arithmetic is compiled for processors with fused multiplication and addition: a type of its
// own, so that templates over it are.
namespace softpoint::inline SOFTPOINT_ABI::figure {

struct FusedScalar {
  double value;
};

#define SOFTPOINT_FUSED inline __attribute__((always_inline))
SOFTPOINT_FUSED FusedScalar operator+(FusedScalar a, FusedScalar b) { return {a.value + b.value}; }
SOFTPOINT_FUSED FusedScalar operator-(FusedScalar a, FusedScalar b) { return {a.value - b.value}; }
SOFTPOINT_FUSED FusedScalar operator*(FusedScalar a, FusedScalar b) { return {a.value * b.value}; }
SOFTPOINT_FUSED FusedScalar operator+(FusedScalar a, double b) { return {a.value + b}; }
SOFTPOINT_FUSED FusedScalar operator-(FusedScalar a, double b) { return {a.value - b}; }
SOFTPOINT_FUSED FusedScalar operator*(FusedScalar a, double b) { return {a.value * b}; }
SOFTPOINT_FUSED FusedScalar operator+(double a, FusedScalar b) { return {a + b.value}; }
SOFTPOINT_FUSED FusedScalar operator-(double a, FusedScalar b) { return {a - b.value}; }
SOFTPOINT_FUSED FusedScalar operator*(double a, FusedScalar b) { return {a * b.value}; }
SOFTPOINT_FUSED FusedScalar operator/(double a, FusedScalar b) { return {a / b.value}; }
SOFTPOINT_FUSED FusedScalar operator-(FusedScalar a) { return {-a.value}; }
SOFTPOINT_FUSED FusedScalar& operator+=(FusedScalar& a, FusedScalar b) {
  a.value += b.value;
  return a;
}
SOFTPOINT_FUSED FusedScalar& operator+=(FusedScalar& a, double b) {
  a.value += b;
  return a;
}
SOFTPOINT_FUSED FusedScalar& operator-=(FusedScalar& a, FusedScalar b) {
  a.value -= b.value;
  return a;
}
#undef SOFTPOINT_FUSED

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
