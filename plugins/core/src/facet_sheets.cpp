#include "facet_sheets.h"

#include <algorithm>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI {

void FacetSheets::find_root(int facet) {
  Node& node = nodes_[static_cast<std::size_t>(facet)];
  while (true) {
    const Node& parent = nodes_[static_cast<std::size_t>(node.parent)];
    if (parent.parent == node.parent) {
      return;
    }
    node.turned ^= parent.turned;
    node.parent = parent.parent;
  }
}

void FacetSheets::align(std::vector<ShapeFacet>& facets) {
  sides_.clear();
  nodes_.clear();
  for (const ShapeFacet& facet : facets) {
    const int f = static_cast<int>(nodes_.size());
    nodes_.push_back({f, false, 0});
    const std::array<const Vec3*, 3> corner = {&facet.a, &facet.b, &facet.c};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3* p = corner[k];
      const Vec3* q = corner[(k + 1) % 3];
      const bool forward = std::lexicographical_compare(p->data(), p->data() + 3, q->data(), q->data() + 3);
      if (!forward) {
        std::swap(p, q);
      }
      sides_.push_back({{p->x(), p->y(), p->z(), q->x(), q->y(), q->z()}, f, forward});
    }
  }
  std::sort(sides_.begin(), sides_.end(), [](const Side& x, const Side& y) {
    return x.ends != y.ends ? x.ends < y.ends : x.facet < y.facet;
  });
  for (std::size_t i = 0; i < sides_.size();) {
    std::size_t end = i + 1;
    while (end < sides_.size() && sides_[end].ends == sides_[i].ends) {
      ++end;
    }
    if (end - i == 2) {
      const Side &one = sides_[i], &other = sides_[i + 1];
      find_root(one.facet);
      find_root(other.facet);
      const Node &a = nodes_[static_cast<std::size_t>(one.facet)],
                 &b = nodes_[static_cast<std::size_t>(other.facet)];
      if (a.parent != b.parent) {  // neighbours that agree run along their edge in opposite ways
        const bool turned = (one.forward == other.forward) != (a.turned != b.turned);
        Node& root = nodes_[static_cast<std::size_t>(b.parent)];
        root.parent = a.parent;
        root.turned = turned;
      }
    }
    i = end;
  }
  for (int f = 0; f < static_cast<int>(nodes_.size()); ++f) {
    find_root(f);
    const Node& node = nodes_[static_cast<std::size_t>(f)];
    nodes_[static_cast<std::size_t>(node.parent)].balance += node.turned ? -1 : 1;
  }
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const Node& node = nodes_[f];
    const bool root_wrong = nodes_[static_cast<std::size_t>(node.parent)].balance < 0;
    if (node.turned != root_wrong) {
      std::swap(facets[f].b, facets[f].c);
      facets[f].normal = -facets[f].normal;
      facets[f].offset = -facets[f].offset;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
