#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "instruction_set.h"
#include "part_group.h"

namespace softpoint::elastic {

// The first group of parts of a design, below the public interface.
struct Mechanics {
  explicit Mechanics(const AssemblyDesign& given, bool single = false)
      : design(given),
        placed(place(design)),
        models(pack(placed, single)),
        group(design, placed, 0, models) {}

  static std::vector<std::shared_ptr<const PackedModel>> pack(const PlacedDesign& placed, bool single) {
    std::vector<std::shared_ptr<const PackedModel>> models;
    for (const PlacedSegment& s : placed.segments) {
      const auto known = [&](const auto& m) { return m->model == s.model; };
      if (std::any_of(models.begin(), models.end(), known)) continue;
      models.push_back(
          pack_model(*s.model, kernels_for(choose_instruction_set(InstructionSet::kAvx512)), single));
    }
    return models;
  }

  AssemblyDesign design;
  PlacedDesign placed;
  std::vector<std::shared_ptr<const PackedModel>> models;
  PartGroup group;
};

}  // namespace softpoint::elastic
