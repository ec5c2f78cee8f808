#pragma once

#include <array>
#include <vector>

#include "collider_shape.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Turns facets so that those of one sheet have their fronts on one side, the side that more of them have
// there already. Facets are of one sheet where exactly two meet at an edge. Keeps its storage.
class FacetSheets {
 public:
  void align(std::vector<ShapeFacet>& facets);

 private:
  struct Side {
    std::array<double, 6> ends{};  // m, the lesser point first
    int facet = 0;
    bool forward = false;
  };
  struct Node {  // of a disjoint-set forest
    int parent = 0;
    bool turned = false;  // against the parent
    int balance = 0;      // of a root: facets that run as it does less those that do not
  };
  // Makes the facet's parent the root of its sheet.
  void find_root(int facet);

  std::vector<Side> sides_;
  std::vector<Node> nodes_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
