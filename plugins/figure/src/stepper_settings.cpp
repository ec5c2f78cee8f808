#include <algorithm>
#include <cmath>

#include "softpoint/core/error.h"
#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// A range is kept to rounding.
void check_inside(const FigureModel& model, const FigureState& state) {
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    if (!has_range(link)) continue;
    const double* q = state.q.data() + model.position_offset(i);
    if (outside_range(link, q) <= (link.joint == JointKind::kBall ? 1e-12 : 0)) continue;
    const std::string field = "link " + std::to_string(i) + " '" + link.name + "' q, with limits";
    if (link.joint != JointKind::kBall) check_range(field, *q, link.lower, link.upper);
    const SwingTwist turn = swing_twist(link, q);
    throw Error(field + " swings by " + to_text(turn.swing) + " rad with a twist of " + to_text(turn.twist) +
                "; permitted is a cone of " + to_text(link.swing_about) + " and " +
                to_text(link.swing_across) + ", twist " + to_text(link.lower) + " to " + to_text(link.upper));
  }
}

[[noreturn]] void refuse_pins(const char* with) {
  throw Error(std::string("pins with ") + with +
              "; permitted are none there, and any with the other integrators and limits");
}

}  // namespace

const char* name(LimitMode mode) {
  switch (mode) {
    case LimitMode::kNone:
      return "none";
    case LimitMode::kPaper:
      return "paper";
    case LimitMode::kExact:
      break;
  }
  return "exact";
}

void FigureStepper::set_dynamic(std::span<const bool> links) {
  Impl& m = *impl_;
  if (links.size() != m.chosen.size()) {
    throw Error("dynamic links: " + std::to_string(links.size()) + " flags; permitted are " +
                std::to_string(m.chosen.size()) + ", one a link");
  }
  for (std::size_t i = 0; i < links.size(); ++i) m.chosen[i] = links[i];
  for (std::size_t i = 0; i < m.limited.size(); ++i) {
    if (!links[static_cast<std::size_t>(m.limited[i].link)]) m.stops[i] = Stop::kFree;
  }
  std::fill(m.held.begin(), m.held.end(), 0);
  m.set_joints();
}

void FigureStepper::set_limits(LimitMode mode) {
  Impl& m = *impl_;
  const bool paper = m.integrator == Integrator::kPaper;
  if ((mode == LimitMode::kPaper && !paper) || (mode == LimitMode::kExact && paper)) {
    throw Error(std::string("limits = ") + name(mode) + " with the integrator " + name(m.integrator) +
                "; permitted are paper with paper, exact with the others");
  }
  if (mode == LimitMode::kExact && m.integrator == Integrator::kVariational && !m.ball_ranges.empty()) {
    throw Error(
        "limits = exact with the integrator variational for balls with cones; permitted are rk4 and "
        "dopri5 there");
  }
  if (mode == LimitMode::kPaper && !m.pins.empty()) refuse_pins("limits paper");
  if (mode != LimitMode::kNone) check_inside(m.dynamics.model(), m.state);
  m.limits = mode;
  std::fill(m.stops.begin(), m.stops.end(), Stop::kFree);
  m.set_joints();
}

void FigureStepper::set_pins(std::vector<PinnedPoint> pins) {
  Impl& m = *impl_;
  const FigureModel& model = m.dynamics.model();
  if (!pins.empty() && m.integrator == Integrator::kVariational) refuse_pins("the integrator variational");
  if (!pins.empty() && m.limits == LimitMode::kPaper) refuse_pins("limits paper");
  std::vector<Impl::Pin> made;
  for (const PinnedPoint& pin : pins) {
    check_index("pin link", pin.link, model.link_count());
    check_finite("pin point", pin.point);
    check_finite("pin place", pin.place);
    made.push_back({LinkChain(model, pin.link), pin});
    const Vec3 now = made.back().chain.evaluate(pin.point, m.state.q.data(), nullptr, nullptr).position;
    check_range("pin on link " + std::to_string(pin.link) + ": distance from its place",
                (now - pin.place).norm(), 0, 1e-6);
  }
  m.pins = std::move(made);
  m.make_room_for_rows();
  m.settle_rows(m.state);
}

void FigureStepper::set_paper_friction(int link, double factor, double reference_dt) {
  Impl& m = *impl_;
  const FigureModel& model = m.dynamics.model();
  check_index("link", link, model.link_count());
  check_range("paper friction factor", factor, 0, 1);
  check_range("paper friction reference_dt", reference_dt, 1e-6, 1);
  const int count = velocity_count(model.links()[static_cast<std::size_t>(link)].joint);
  const double rate = factor > 0 ? std::log(factor) / reference_dt : -1e12;
  std::fill_n(m.friction.begin() + model.velocity_offset(link), count, rate);
}

void FigureStepper::set_state(const FigureState& state) {
  Impl& m = *impl_;
  m.stage = state;
  check_state(m.dynamics.model(), m.stage);
  if (m.limits != LimitMode::kNone) check_inside(m.dynamics.model(), m.stage);
  std::swap(m.state, m.stage);
  std::fill(m.stops.begin(), m.stops.end(), Stop::kFree);
  m.set_joints();
}

void FigureStepper::set_time(double time) {
  check_range("time", time, -1e9, 1e9);
  impl_->time = time;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
