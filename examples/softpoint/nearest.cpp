#include "nearest.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr std::size_t kMaxWord = 64;  // longer words are no typing errors

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  const int columns = static_cast<int>(b.size()) + 1;
  std::vector<int> before(columns), above(columns), row(columns);
  for (int j = 0; j < columns; ++j) {
    above[j] = j;
  }
  for (int i = 1; i <= static_cast<int>(a.size()); ++i) {
    row[0] = i;
    for (int j = 1; j < columns; ++j) {
      const bool same = a[i - 1] == b[j - 1];
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(above);
    above.swap(row);
  }
  return above.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  if (word.size() > kMaxWord) {
    return "";
  }
  std::string best;
  int best_distance = std::max<int>(2, static_cast<int>(word.size()) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const int distance = edit_distance(word, candidate);
    // A word that shares no letter with the candidate is no misspelling of it.
    if (distance < best_distance && distance < static_cast<int>(std::max(word.size(), candidate.size()))) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
