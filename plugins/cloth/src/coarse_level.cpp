#include "coarse_level.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

constexpr int kMostNodesASide = 14;

// Nodes from 0 to `count` - 1 points, about `side` apart.
int cells_along(int count, int side) {
  return std::clamp((count - 1 + side / 2) / side, 1, kMostNodesASide - 1);
}

}  // namespace

CoarseLevel::CoarseLevel(const ClothPattern& pattern, int side) : bends_(pattern.bends) {
  if (pattern.columns > 1 && pattern.columns * pattern.rows == pattern.point_count()) {
    lay_grid(pattern, side);
  } else {
    lay_mesh(pattern, side);
  }
  for (const Spring& spring : pattern.springs) {
    Link link{};
    const auto place = [&](int node) {
      for (int k = 0; k < link.count; ++k) {
        if (link.node[k] == node) return k;
      }
      link.node[link.count] = node;
      return link.count++;
    };
    for (int k = 0; k < kCorners; ++k) {
      if (weight_[kCorners * spring.a + k] != 0) {
        link.a[place(node_[kCorners * spring.a + k])] += weight_[kCorners * spring.a + k];
      }
      if (weight_[kCorners * spring.b + k] != 0) {
        link.b[place(node_[kCorners * spring.b + k])] += weight_[kCorners * spring.b + k];
      }
    }
    for (int k = 0; k < link.count; ++k) {
      for (int l = 0; l < k; ++l) band_ = std::max(band_, 3 * std::abs(link.node[k] - link.node[l]) + 2);
    }
    links_.push_back(link);
  }
  for (const BendElement& bend : bends_) {
    int low = nodes_, high = 0;
    for (int point : bend.point) {
      for (int k = 0; k < kCorners; ++k) {
        low = std::min(low, node_[kCorners * point + k]);
        high = std::max(high, node_[kCorners * point + k]);
      }
    }
    band_ = std::max(band_, 3 * (high - low) + 2);
  }
  band_ = std::max(band_, 2);
  matrix_.assign(static_cast<std::size_t>(3 * nodes_) * (band_ + 1), 0.0);
  right_.assign(3 * nodes_, 0.0);
}

void CoarseLevel::lay_grid(const ClothPattern& pattern, int side) {
  const int nx = cells_along(pattern.columns, side), ny = cells_along(pattern.rows, side);
  nodes_ = (nx + 1) * (ny + 1);
  // Neighbours in the shorter direction get neighbouring numbers.
  const bool along_x = nx <= ny;
  const auto number = [&](int i, int j) { return along_x ? j * (nx + 1) + i : i * (ny + 1) + j; };
  for (int j = 0; j < pattern.rows; ++j) {
    for (int i = 0; i < pattern.columns; ++i) {
      const double x = static_cast<double>(i) * nx / (pattern.columns - 1);
      const double y = static_cast<double>(j) * ny / (pattern.rows - 1);
      const int cx = std::min(static_cast<int>(x + 1e-9), nx - 1),
                cy = std::min(static_cast<int>(y + 1e-9), ny - 1);
      const double u = x - cx, v = y - cy;
      const double w[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
      for (int k = 0; k < 4; ++k) {
        node_.push_back(number(cx + k % 2, cy + k / 2));
        weight_.push_back(std::abs(w[k]) < 1e-12 ? 0 : w[k]);
      }
    }
  }
}

// Patches grown one after the other round the first point that is left, then smoothed.
void CoarseLevel::lay_mesh(const ClothPattern& pattern, int side) {
  const int n = pattern.point_count();
  const int size = std::max(side * side, n / (kMostNodesASide * kMostNodesASide) + 1);
  std::vector<std::vector<int>> near(n);
  for (const Spring& spring : pattern.springs) {
    near[spring.a].push_back(spring.b);
    near[spring.b].push_back(spring.a);
  }
  std::vector<int> patch(n, -1);
  std::vector<int> queue;
  for (int first = 0; first < n; ++first) {
    if (patch[first] >= 0) continue;
    queue.assign(1, first);
    patch[first] = nodes_;
    for (std::size_t k = 0; k < queue.size() && static_cast<int>(queue.size()) < size; ++k) {
      for (int q : near[queue[k]]) {
        if (patch[q] >= 0 || static_cast<int>(queue.size()) >= size) continue;
        patch[q] = nodes_;
        queue.push_back(q);
      }
    }
    ++nodes_;
  }
  std::vector<std::map<int, double>> weights(n), smooth(n);
  for (int p = 0; p < n; ++p) weights[p][patch[p]] = 1;
  for (int pass = 0; pass < side; ++pass) {
    for (int p = 0; p < n; ++p) {
      smooth[p] = weights[p];
      if (near[p].empty()) continue;
      for (auto& entry : smooth[p]) entry.second *= 0.5;
      for (int q : near[p]) {
        for (const auto& [k, w] : weights[q]) smooth[p][k] += 0.5 * w / static_cast<double>(near[p].size());
      }
    }
    weights.swap(smooth);
  }
  for (int p = 0; p < n; ++p) {
    std::vector<std::pair<double, int>> most;
    for (const auto& [k, w] : weights[p]) most.push_back({-w, k});
    std::sort(most.begin(), most.end());
    most.resize(std::min<std::size_t>(most.size(), kCorners));
    double sum = 0;
    for (const auto& m : most) sum -= m.first;
    for (int k = 0; k < kCorners; ++k) {
      const bool there = k < static_cast<int>(most.size());
      node_.push_back(there ? most[k].second : most[0].second);
      weight_.push_back(there ? -most[k].first / sum : 0);
    }
  }
}

void CoarseLevel::add_pair(int k, int l, double factor, const double (&h)[6]) {
  if (k < l) std::swap(k, l);
  constexpr int kEntry[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  for (int r = 0; r < 3; ++r) {
    double* row =
        matrix_.data() + static_cast<std::size_t>(3 * k + r) * (band_ + 1) + band_ - (3 * k + r) + 3 * l;
    const int last = k == l ? r : 2;
    for (int c = 0; c <= last; ++c) row[c] += factor * h[kEntry[r][c]];
  }
}

void CoarseLevel::begin(std::span<const double> inertia) {
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  for (std::size_t p = 0; p < inertia.size(); ++p) {
    const double m[6] = {inertia[p], inertia[p], inertia[p], 0, 0, 0};
    if (inertia[p] == 0) continue;
    for (int k = 0; k < kCorners; ++k) {
      for (int l = 0; l <= k; ++l) {
        const double w = weight_[kCorners * p + k] * weight_[kCorners * p + l];
        if (w != 0) add_pair(node_[kCorners * p + k], node_[kCorners * p + l], w, m);
      }
    }
  }
}

void CoarseLevel::add_spring(int spring, const double (&h)[6], bool a_moves, bool b_moves) {
  const Link& link = links_[spring];
  double d[2 * kCorners];
  for (int k = 0; k < link.count; ++k) d[k] = (a_moves ? link.a[k] : 0) - (b_moves ? link.b[k] : 0);
  for (int k = 0; k < link.count; ++k) {
    if (d[k] == 0) continue;
    for (int l = 0; l <= k; ++l) {
      if (d[l] != 0) add_pair(link.node[k], link.node[l], d[k] * d[l], h);
    }
  }
}

void CoarseLevel::add_bend(int bend, double stiffness, std::span<const char> moves) {
  const BendElement& element = bends_[bend];
  int node[4 * kCorners];
  double w[4 * kCorners];
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    const int p = element.point[i];
    if (!moves[p] || element.weight[i] == 0) continue;
    for (int k = 0; k < kCorners; ++k) {
      const double add = element.weight[i] * weight_[kCorners * p + k];
      if (add == 0) continue;
      int at = 0;
      while (at < count && node[at] != node_[kCorners * p + k]) ++at;
      if (at == count) node[count] = node_[kCorners * p + k], w[count++] = 0;
      w[at] += add;
    }
  }
  const double h[6] = {stiffness, stiffness, stiffness, 0, 0, 0};
  for (int k = 0; k < count; ++k) {
    for (int l = 0; l <= k; ++l) add_pair(node[k], node[l], w[k] * w[l], h);
  }
}

bool CoarseLevel::factor() {
  const int n = 3 * nodes_, stride = band_ + 1;
  double greatest = 0;
  for (int i = 0; i < n; ++i)
    greatest = std::max(greatest, matrix_[static_cast<std::size_t>(i) * stride + band_]);
  if (!(greatest > 0) || !std::isfinite(greatest)) return false;
  for (int i = 0; i < n; ++i) {
    double* row =
        matrix_.data() + static_cast<std::size_t>(i) * stride + band_ - i;  // row[j] is entry (i, j)
    row[i] += 1e-9 * greatest;                                              // nodes none of whose points move
    for (int j = std::max(0, i - band_); j <= i; ++j) {
      const double* other = matrix_.data() + static_cast<std::size_t>(j) * stride + band_ - j;
      double sum = row[j];
      for (int k = std::max(0, i - band_); k < j; ++k) sum -= row[k] * other[k];
      if (j < i) {
        row[j] = sum / other[j];
      } else {
        if (!(sum > 0)) return false;
        row[i] = std::sqrt(sum);
      }
    }
  }
  return true;
}

void CoarseLevel::solve(std::span<double> x) const {
  const int n = 3 * nodes_, stride = band_ + 1;
  for (int i = 0; i < n; ++i) {
    const double* row = matrix_.data() + static_cast<std::size_t>(i) * stride + band_ - i;
    // Four sums, or each product would wait for the one before.
    double sums[4] = {x[i], 0, 0, 0};
    int k = std::max(0, i - band_);
    for (; k + 4 <= i; k += 4) {
      for (int c = 0; c < 4; ++c) sums[c] -= row[k + c] * x[k + c];
    }
    for (; k < i; ++k) sums[0] -= row[k] * x[k];
    x[i] = (sums[0] + sums[1] + sums[2] + sums[3]) / row[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    const double* row = matrix_.data() + static_cast<std::size_t>(i) * stride + band_ - i;
    x[i] /= row[i];
    for (int k = std::max(0, i - band_); k < i; ++k) x[k] -= row[k] * x[i];
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
