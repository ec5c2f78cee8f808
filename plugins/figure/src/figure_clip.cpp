#include "softpoint/figure/figure_clip.h"

#include <algorithm>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

void check_interval(const std::string& who, double begin, double end, double last) {
  check_range(who + " begin", begin, 0, last);
  check_range(who + " end", end, begin, last);
  if (!(end - begin >= 1e-6)) {
    throw Error(who + " end = " + to_text(end) + "; permitted is 1e-06 s or more after its begin");
  }
}

template <class Interval>
bool overlap(const Interval& a, const Interval& b) {
  return a.begin < b.end - 1e-9 && b.begin < a.end - 1e-9;
}

}  // namespace

void check_clip(const FigureModel& model, FigureClip& clip) {
  check_range("clip end", clip.end, 1e-6, 1e5);
  FigureClip next = clip;
  std::vector<char> has(static_cast<std::size_t>(model.link_count()), 0);
  for (JointTrack& track : next.tracks) {
    check_track(model, track);
    char& taken = has[static_cast<std::size_t>(track.link)];
    if (taken) {
      throw Error("tracks: two of link " + std::to_string(track.link) + "; permitted is one a link");
    }
    taken = 1;
  }
  for (std::size_t i = 0; i < next.dynamics.size(); ++i) {
    const DynamicInterval& interval = next.dynamics[i];
    const std::string who = "dynamic interval " + std::to_string(i);
    check_interval(who, interval.begin, interval.end, clip.end);
    if (interval.links.empty()) throw Error(who + " has no links; permitted is at least one");
    for (const int link : interval.links) {
      check_index(who + " link", link, model.link_count());
      if (link == 0 && model.links()[0].joint == JointKind::kFree) {
        throw Error(who + " link = 0, the free base; its place goes by the rules of `places`");
      }
      if (std::count(interval.links.begin(), interval.links.end(), link) > 1) {
        throw Error(who + " names link " + std::to_string(link) + " twice; permitted is once");
      }
      for (std::size_t k = 0; k < i; ++k) {
        const DynamicInterval& other = next.dynamics[k];
        if (overlap(interval, other) && std::count(other.links.begin(), other.links.end(), link) > 0) {
          throw Error(who + " takes link " + std::to_string(link) + " while interval " + std::to_string(k) +
                      " does; permitted is one at a time");
        }
      }
    }
  }
  for (std::size_t i = 0; i < next.places.size(); ++i) {
    const PlaceInterval& place = next.places[i];
    const std::string who = "place " + std::to_string(i);
    check_interval(who, place.begin, place.end, clip.end);
    const bool any = place.rule == PlaceRule::kGravity && place.link == -1;
    if (!any) check_index(who + " link", place.link, model.link_count());
    if (place.other != -1) check_index(who + " other", place.other, model.link_count());
    check_range(who + " point", place.point, -kMaxPosition, kMaxPosition);
    if (place.rule == PlaceRule::kHold && place.other == place.link) {
      throw Error(who + " other = " + std::to_string(place.other) +
                  ", the link that is held already; permitted "
                  "is another one, or -1");
    }
    if (place.rule != PlaceRule::kKeyed && model.links()[0].joint != JointKind::kFree) {
      throw Error(who + " for a figure whose first link is " + name(model.links()[0].joint) +
                  "; permitted is a free one");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (overlap(place, next.places[k])) {
        throw Error(who + " begins while place " + std::to_string(k) + " holds; permitted is one at a time");
      }
    }
  }
  FigureCollision(model, next.capsules, next.obstacles);  // refuses what is out of range
  clip = std::move(next);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
