#include "softpoint/figure/figure_animation.h"

#include <algorithm>
#include <cmath>

#include "figure_animation_impl.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "state_between.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

void check_hold(const FigureClip& clip, const AnimationSettings& settings) {
  const bool good = settings.limits != LimitMode::kPaper && settings.integrator != Integrator::kVariational;
  for (const PlaceInterval& p : clip.places) {
    if (p.rule != PlaceRule::kHold || good) continue;
    throw Error(std::string("places: hold with the integrator ") + name(settings.integrator) +
                " and limits " + name(settings.limits) +
                "; permitted are other integrators than variational, none and exact");
  }
}

}  // namespace

FigureAnimation::Impl::Impl(const FigureModel& of, FigureClip what, AnimationSettings how)
    : model(of), clip(std::move(what)), settings(std::move(how)) {
  check_clip(model, clip);
  check_hold(clip, settings);
  check_range("frame_time", settings.frame_time, 1e-5, 1);
  check_range("substeps", settings.substeps, 1, 10000);
  check_range("friction", settings.friction, 0, 100);
  check_range("gravity", settings.gravity, -kMaxAcceleration, kMaxAcceleration);
  DynamicPiece(model, {}, settings, splines);  // refuses what does not go together
  is_dynamic.assign(static_cast<std::size_t>(model.link_count()), 0);
  scratch.resize(static_cast<std::size_t>(model.velocity_count()));
}

// Which joints are dynamic from a time on, and the pieces into which the prescribed ones cut them.
void FigureAnimation::Impl::choose_dynamic(double time) {
  std::fill(is_dynamic.begin(), is_dynamic.end(), 0);
  for (const DynamicInterval& d : clip.dynamics) {
    if (time < d.begin - 1e-7 || time > d.end - 1e-7) continue;
    for (const int link : d.links) is_dynamic[static_cast<std::size_t>(link)] = 1;
  }
  bool one = false;  // a base that leans on dynamic joints couples all
  if (base.pinned != nullptr) {
    for (const int link : base.pinned->links()) one = one || is_dynamic[static_cast<std::size_t>(link)];
  }
  std::vector<std::vector<int>> groups;
  std::vector<int> group(is_dynamic.size(), -1);
  for (int i = 0; i < model.link_count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int parent = model.links()[k].parent;
    if (parent >= 0) group[k] = group[static_cast<std::size_t>(parent)];
    if (!is_dynamic[k]) continue;
    if (one && !groups.empty()) group[k] = 0;
    if (group[k] < 0) {
      group[k] = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[static_cast<std::size_t>(group[k])].push_back(i);
  }
  active.clear();
  for (std::vector<int>& links : groups) {
    std::unique_ptr<DynamicPiece>& piece = pieces[links];
    if (!piece) piece = std::make_unique<DynamicPiece>(model, links, settings, splines);
    active.push_back(piece.get());
  }
}

void FigureAnimation::Impl::choose_base(double time, const FigureState& at) {
  int now = -1;
  for (std::size_t i = 0; i < clip.places.size(); ++i) {
    if (time > clip.places[i].begin - 1e-7 && time < clip.places[i].end - 1e-7) now = static_cast<int>(i);
  }
  if (now == place) return;
  place = now;
  base = {};
  by_gravity = by_contact = false;
  feet.clear();
  if (now < 0 || clip.places[static_cast<std::size_t>(now)].rule == PlaceRule::kKeyed) return;
  const PlaceInterval& rule = clip.places[static_cast<std::size_t>(now)];
  if (rule.rule == PlaceRule::kFeet) {
    for (const int link : {rule.link, rule.other}) {
      if (link < 0) continue;
      FootSolver foot(model, link, rule.point);
      const Vec3 where = foot.where(at);
      feet.emplace_back(std::move(foot), where);
    }
    return;
  }
  if (rule.rule == PlaceRule::kContact || rule.rule == PlaceRule::kHold) {
    by_contact = true;
    std::vector<PinnedPoint> pins;
    for (const int link : {rule.link, rule.other}) {
      if (link < 0 || rule.rule == PlaceRule::kContact) continue;
      const LinkChain chain(model, link);
      pins.push_back({link, rule.point, chain.evaluate(rule.point, at.q.data(), nullptr, nullptr).position});
    }
    landing->hold(std::move(pins));
    return;
  }
  if (rule.rule == PlaceRule::kGravity) {
    by_gravity = true;
    gravity->begin(rule, time, at);
    base = gravity->guess(time, at);
    return;
  }
  const LinkChain& chain = chains.try_emplace(rule.link, model, rule.link).first->second;
  base.pinned = &chain;
  base.point = rule.point;
  base.place = chain.evaluate(rule.point, at.q.data(), nullptr, nullptr).position;
}

// The keyed joints; those that are dynamic keep their values.
void FigureAnimation::Impl::make_state(double time, FigureState& to) {
  for (int i = 0; i < model.link_count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (is_dynamic[k] || !splines[k]) continue;
    const int v = model.velocity_offset(i);
    splines[k]->evaluate(time, to.q.data() + model.position_offset(i), to.qd.data() + v, scratch.data() + v);
  }
}

bool FigureAnimation::Impl::ends_soon(const DynamicPiece& piece, double time) const {
  for (const DynamicInterval& d : clip.dynamics) {
    if (std::abs(d.end - time) > 1e-7) continue;
    for (const int link : piece.links()) {
      const bool quintic = tracks[static_cast<std::size_t>(link)].interpolation == Interpolation::kQuintic;
      if (quintic && std::count(d.links.begin(), d.links.end(), link) > 0) return true;
    }
  }
  return false;
}

void FigureAnimation::Impl::evaluate() {
  ++counts.evaluations;
  make_ticks();
  const FigureState rest = rest_state(model);
  states.assign(ticks.size(), rest);
  tracks.assign(static_cast<std::size_t>(model.link_count()), {});
  splines.assign(static_cast<std::size_t>(model.link_count()), std::nullopt);
  for (const JointTrack& track : clip.tracks) {
    tracks[static_cast<std::size_t>(track.link)] = track;
    make_spline(track, -1e300, nullptr, {});
  }
  events.clear();
  bool wants_gravity = false, wants_contact = false;
  for (const PlaceInterval& p : clip.places)
    wants_contact = wants_contact || p.rule == PlaceRule::kContact || p.rule == PlaceRule::kHold;
  if (wants_contact) landing = std::make_unique<LandingRule>(model, clip, settings, splines);
  for (const PlaceInterval& p : clip.places) wants_gravity = wants_gravity || p.rule == PlaceRule::kGravity;
  if (wants_gravity) gravity = std::make_unique<GravityRule>(model, clip, settings);
  std::fill(is_dynamic.begin(), is_dynamic.end(), 0);
  make_state(0, states[0]);
  place = -2;
  choose_base(0, states[0]);
  base.apply(model, states[0].q.data(), states[0].qd.data(), nullptr);
  choose_dynamic(0);
  for (std::size_t n = 0; n + 1 < ticks.size(); ++n) {
    const double time = ticks[n], dt = ticks[n + 1] - time;
    FigureState& next = states[n + 1];
    next = states[n];
    make_state(time + dt, next);
    if (by_contact) landing->advance(time, dt, is_dynamic, states[n], next, events, counts);
    for (DynamicPiece* piece : active) {
      if (by_contact) break;
      piece->advance(n, time, dt, base, states[n], ends_soon(*piece, time + dt), next, counts);
    }
    for (auto& [foot, where] : feet)
      counts.feet_missed = std::max(counts.feet_missed, foot.solve(where, next));
    if (by_gravity) {
      gravity->place(time, dt, states[n], next, events);
      base = gravity->guess(time + dt, next);
    } else if (!by_contact) {
      base.apply(model, next.q.data(), next.qd.data(), nullptr);
    }
    // What ends here goes on by keys from the state it has.
    bool changed = false;
    for (const DynamicInterval& d : clip.dynamics) {
      if (std::abs(d.begin - ticks[n + 1]) < 1e-7) changed = true;
      if (std::abs(d.end - ticks[n + 1]) > 1e-7) continue;
      changed = true;
      for (const int link : d.links) {
        JointTrack track = tracks[static_cast<std::size_t>(link)];
        track.link = link;
        std::vector<double> acceleration;
        for (const DynamicPiece* piece : active) {
          const std::vector<int>& own = piece->links();
          const bool is = std::count(own.begin(), own.end(), link) > 0;
          if (is && ends_soon(*piece, ticks[n + 1])) acceleration = piece->acceleration(link);
        }
        make_spline(track, ticks[n + 1], &next, acceleration);
      }
    }
    for (const auto& [foot, where] : feet) {  // bent limbs go on from where they are
      if (clip.places[static_cast<std::size_t>(place)].end > ticks[n + 1] + 1e-7) continue;
      for (const int link : foot.joints()) {
        JointTrack track = tracks[static_cast<std::size_t>(link)];
        track.link = link;
        make_spline(track, ticks[n + 1], &next, {});
      }
    }
    const int before = place;
    choose_base(ticks[n + 1], next);
    if (changed || place != before || by_gravity) choose_dynamic(ticks[n + 1]);
  }
  if (wants_contact) {
    counts.boxes_overlapping += landing->counts().overlapping;
    counts.narrow_tests += landing->counts().narrow;
  }
  if (wants_gravity) {
    counts.boxes_overlapping += gravity->counts().overlapping;
    counts.narrow_tests += gravity->counts().narrow;
  }
}

FigureAnimation::FigureAnimation(const FigureModel& model, FigureClip clip, AnimationSettings settings)
    : impl_(std::make_unique<Impl>(model, std::move(clip), std::move(settings))) {}
FigureAnimation::~FigureAnimation() = default;
FigureAnimation::FigureAnimation(FigureAnimation&&) noexcept = default;
FigureAnimation& FigureAnimation::operator=(FigureAnimation&&) noexcept = default;

const FigureModel& FigureAnimation::model() const { return impl_->model; }
const FigureClip& FigureAnimation::clip() const { return impl_->clip; }
const AnimationSettings& FigureAnimation::settings() const { return impl_->settings; }
const std::vector<PlaceEvent>& FigureAnimation::events() const { return impl_->events; }
const AnimationCounts& FigureAnimation::counts() const { return impl_->counts; }
void FigureAnimation::evaluate() { impl_->evaluate(); }

void FigureAnimation::set_clip(FigureClip clip) {
  check_clip(impl_->model, clip);
  check_hold(clip, impl_->settings);
  impl_->clip = std::move(clip);
}

void FigureAnimation::set_key(int track, int key, JointKey value) {
  check_index("track", track, static_cast<long long>(impl_->clip.tracks.size()));
  JointTrack next = impl_->clip.tracks[static_cast<std::size_t>(track)];
  check_index("key", key, static_cast<long long>(next.keys.size()));
  next.keys[static_cast<std::size_t>(key)] = std::move(value);
  check_track(impl_->model, next);
  impl_->clip.tracks[static_cast<std::size_t>(track)] = std::move(next);
}

int FigureAnimation::frame_count() const { return static_cast<int>(impl_->frame_ticks.size()); }

const FigureState& FigureAnimation::frame(int index) const {
  check_index("frame", index, frame_count());
  return impl_->states[impl_->frame_ticks[static_cast<std::size_t>(index)]];
}

void FigureAnimation::sample(double time, FigureState& to) const {
  const Impl& m = *impl_;
  if (m.states.empty())
    throw Error("sample of an animation that was not evaluated; permitted after evaluate()");
  const auto it = std::upper_bound(m.ticks.begin(), m.ticks.end(), time);
  const std::size_t n = it == m.ticks.begin() ? 0 : static_cast<std::size_t>(it - m.ticks.begin()) - 1;
  if (n + 1 >= m.ticks.size() || time <= m.ticks.front()) {
    to = m.states[n];
    if (time > m.ticks.back() || time < m.ticks.front()) std::fill(to.qd.begin(), to.qd.end(), 0.0);
    return;
  }
  const double h = m.ticks[n + 1] - m.ticks[n];
  state_between(m.model, m.states[n], m.states[n + 1], h, (time - m.ticks[n]) / h, to);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
