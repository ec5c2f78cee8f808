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
    if (link.joint != JointKind::kHinge && link.joint != JointKind::kPrismatic) continue;
    check_range("link " + std::to_string(i) + " '" + link.name + "' q, with limits",
                state.q[static_cast<std::size_t>(model.position_offset(i))], link.lower, link.upper);
  }
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
  if (mode != LimitMode::kNone) check_inside(m.dynamics.model(), m.state);
  m.limits = mode;
  std::fill(m.stops.begin(), m.stops.end(), Stop::kFree);
  m.set_joints();
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

void FigureStepper::set_state(FigureState state) {
  Impl& m = *impl_;
  check_state(m.dynamics.model(), state);
  if (m.limits != LimitMode::kNone) check_inside(m.dynamics.model(), state);
  m.state = std::move(state);
  std::fill(m.stops.begin(), m.stops.end(), Stop::kFree);
  m.set_joints();
}

void FigureStepper::set_time(double time) {
  check_range("time", time, -1e9, 1e9);
  impl_->time = time;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
