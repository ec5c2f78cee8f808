// Biovision files: read, made a figure of, written and read back.
#include <cmath>
#include <sstream>

#include "fuzz/fuzz_support.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/bvh.h"

using namespace softpoint;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 1 << 16) return 0;
  const std::string text(reinterpret_cast<const char*>(data), size);
  figure::BvhClip clip;
  try {
    std::istringstream in(text);
    clip = figure::read_bvh(in, "fuzz");
  } catch (const Error&) {
    return 0;
  }
  for (const double value : clip.values) fuzz::require(std::isfinite(value), "channels are finite");
  std::istringstream in(figure::bvh_text(clip));
  const figure::BvhClip copy = figure::read_bvh(in, "copy");
  fuzz::require(copy.joints.size() == clip.joints.size() && copy.values == clip.values,
                "a clip is written as it was read");
  try {
    const figure::FigureModel model = figure::bvh_figure(clip);
    if (clip.frame_count() > 0) {
      figure::FigureState state = figure::rest_state(model);
      state.q = figure::bvh_positions(clip, 0);
      figure::check_state(model, state);
    }
  } catch (const Error&) {
  }
  return 0;
}
