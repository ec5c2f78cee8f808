// Facets of one sheet get their fronts on one side.
#include <algorithm>

#include "shape_features.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Which facets share a side, and whether one of the two is turned against the other.
void find_neighbours(const std::vector<ShapeFacet>& facets, FeatureWorkspace& work) {
  auto& borders = work.borders;
  borders.clear();
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const std::array<const Vec3*, 3> corner = {&facets[f].a, &facets[f].b, &facets[f].c};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3* p = corner[k];
      const Vec3* q = corner[(k + 1) % 3];
      const bool forward = std::lexicographical_compare(p->data(), p->data() + 3, q->data(), q->data() + 3);
      if (!forward) {
        std::swap(p, q);
      }
      borders.push_back({{p->x(), p->y(), p->z(), q->x(), q->y(), q->z()}, static_cast<int>(f), forward});
    }
  }
  std::sort(borders.begin(), borders.end(), [](const auto& x, const auto& y) {
    return x.ends != y.ends ? x.ends < y.ends : x.facet < y.facet;
  });
  work.neighbours.assign(facets.size(), {});
  const auto link = [&](int from, int to, bool flipped) {
    auto& neighbours = work.neighbours[static_cast<std::size_t>(from)];
    neighbours.links[static_cast<std::size_t>(neighbours.count++)] = {to, flipped};
  };
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const bool pair = borders[i].ends == borders[i + 1].ends &&
                      (i == 0 || borders[i - 1].ends != borders[i].ends) &&
                      (i + 2 == borders.size() || borders[i + 2].ends != borders[i].ends);
    if (pair) {
      const bool flipped = borders[i].forward == borders[i + 1].forward;
      link(borders[i].facet, borders[i + 1].facet, flipped);
      link(borders[i + 1].facet, borders[i].facet, flipped);
    }
  }
}

}  // namespace

void align_facets(std::vector<ShapeFacet>& facets, FeatureWorkspace& work) {
  find_neighbours(facets, work);
  auto& turn = work.turn;
  auto& sheet = work.sheet;
  turn.assign(facets.size(), 0);
  for (std::size_t seed = 0; seed < facets.size(); ++seed) {
    if (turn[seed] != 0) {
      continue;
    }
    sheet.assign(1, seed);
    turn[seed] = 1;
    int balance = 0;
    for (std::size_t i = 0; i < sheet.size(); ++i) {
      const std::size_t at = sheet[i];
      balance += turn[at];
      for (int k = 0; k < work.neighbours[at].count; ++k) {
        const auto& link = work.neighbours[at].links[static_cast<std::size_t>(k)];
        const auto other = static_cast<std::size_t>(link.facet);
        if (turn[other] == 0) {
          turn[other] = link.flipped ? static_cast<signed char>(-turn[at]) : turn[at];
          sheet.push_back(other);
        }
      }
    }
    for (const std::size_t f : sheet) {
      if (turn[f] * (balance < 0 ? -1 : 1) < 0) {
        std::swap(facets[f].b, facets[f].c);
        facets[f].normal = -facets[f].normal;
        facets[f].offset = -facets[f].offset;
      }
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
