#pragma once

#include <memory>

#include "json_reader.h"
#include "softpoint/figure/figure_animation.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A figure that a file describes.
struct FigureFromFile {
  std::shared_ptr<const figure::FigureModel> model;
  std::vector<figure::LinkCapsule> capsules;
  std::vector<figure::JointTrack> tracks;  // of a motion in the file, if it has one
};

// Reads the object at "model"; no model if there is none.
FigureFromFile read_figure_file(ObjectReader& item);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
