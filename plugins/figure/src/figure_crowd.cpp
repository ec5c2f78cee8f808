#include "softpoint/figure/figure_crowd.h"

#include <algorithm>

#include "crowd_kernel.h"
#include "lane_plan.h"
#include "pack_array.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "tree.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

CrowdKernel kernel_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return crowd_kernel_avx512();
    case InstructionSet::kAvx2:
      return crowd_kernel_avx2();
    case InstructionSet::kBaseline:
      break;
  }
  return crowd_kernel_baseline();
}

}  // namespace

struct __attribute__((visibility("hidden"))) FigureCrowd::Impl {
  Impl(const FigureModel& model, int count, InstructionSet limit)
      : figures(count),
        set(choose_instruction_set(limit)),
        kernel(kernel_for(set)),
        positions(static_cast<std::size_t>(model.position_count())),
        velocities(static_cast<std::size_t>(model.velocity_count())) {
    const auto lanes = static_cast<std::size_t>(kernel.lanes);
    const std::size_t blocks = (static_cast<std::size_t>(count) + lanes - 1) / lanes;
    // One number more, that arrays of figures without joints are none too.
    q.resize((blocks * positions + 1) * lanes);
    qd.resize((blocks * velocities + 1) * lanes);
    tau.resize((blocks * velocities + 1) * lanes);
    qdd.resize((blocks * velocities + 1) * lanes);
    const Tree tree = build_tree(model);
    plan = plan_lanes(tree);
    work.resize(static_cast<std::size_t>(plan.slots * kernel.slot_size) +
                plan.steps.size() * static_cast<std::size_t>(kernel.work_size) +
                static_cast<std::size_t>(tree.balls * kernel.ball_size));
    const FigureState rest = rest_state(model);
    for (std::size_t block = 0; block < blocks; ++block) {  // lanes without a figure stand too
      for (std::size_t k = 0; k < positions; ++k) {
        std::fill_n(q.data() + (block * positions + k) * lanes, lanes, rest.q[k]);
      }
    }
  }

  // Number k of a figure's in an array with `count` of them a figure.
  std::size_t place(int figure, std::size_t count, std::size_t k) const {
    const auto f = static_cast<std::size_t>(figure), lanes = static_cast<std::size_t>(kernel.lanes);
    return (f / lanes * count + k) * lanes + f % lanes;
  }
  void check(int figure, std::size_t got, std::size_t wanted, const char* what) const {
    check_index("figure", figure, figures);
    if (got != wanted) {
      throw Error(std::string(what) + " has " + std::to_string(got) + " numbers; permitted are " +
                  std::to_string(wanted) + " for this figure");
    }
  }

  LanePlan plan;
  int figures;
  InstructionSet set;
  CrowdKernel kernel;
  std::size_t positions, velocities;
  Vec3 gravity{0, 0, -9.81};
  PackArray q, qd, tau, qdd, work;
};

FigureCrowd::FigureCrowd(const FigureModel& model, int figures, InstructionSet limit) {
  if (figures < 1 || figures > 1000000) {
    throw Error("figures = " + std::to_string(figures) + "; permitted are 1 to 1000000");
  }
  impl_ = std::make_unique<Impl>(model, figures, limit);
}
FigureCrowd::~FigureCrowd() = default;
FigureCrowd::FigureCrowd(FigureCrowd&&) noexcept = default;
FigureCrowd& FigureCrowd::operator=(FigureCrowd&&) noexcept = default;

int FigureCrowd::size() const { return impl_->figures; }
int FigureCrowd::lanes() const { return impl_->kernel.lanes; }
InstructionSet FigureCrowd::instruction_set() const { return impl_->set; }

void FigureCrowd::set_gravity(const Vec3& gravity) {
  check_range("gravity", gravity, -kMaxAcceleration, kMaxAcceleration);
  impl_->gravity = gravity;
}

void FigureCrowd::set_state(int figure, std::span<const double> q, std::span<const double> qd) {
  Impl& m = *impl_;
  m.check(figure, q.size(), m.positions, "q");
  m.check(figure, qd.size(), m.velocities, "qd");
  for (std::size_t k = 0; k < q.size(); ++k) m.q.data()[m.place(figure, m.positions, k)] = q[k];
  for (std::size_t k = 0; k < qd.size(); ++k) m.qd.data()[m.place(figure, m.velocities, k)] = qd[k];
}

void FigureCrowd::set_torque(int figure, std::span<const double> tau) {
  Impl& m = *impl_;
  m.check(figure, tau.size(), m.velocities, "tau");
  for (std::size_t k = 0; k < tau.size(); ++k) m.tau.data()[m.place(figure, m.velocities, k)] = tau[k];
}

void FigureCrowd::forward() {
  Impl& m = *impl_;
  const auto lanes = static_cast<std::size_t>(m.kernel.lanes);
  const std::size_t blocks = (static_cast<std::size_t>(m.figures) + lanes - 1) / lanes;
  CrowdBlock block{m.plan.steps.data(),
                   m.plan.bodies.data(),
                   static_cast<int>(m.plan.steps.size()),
                   m.plan.slots,
                   m.gravity.data(),
                   nullptr,
                   nullptr,
                   nullptr,
                   nullptr,
                   m.work.data()};
  for (std::size_t i = 0; i < blocks; ++i) {
    block.tau = m.tau.data() + i * m.velocities * lanes;
    block.q = m.q.data() + i * m.positions * lanes;
    block.qd = m.qd.data() + i * m.velocities * lanes;
    block.qdd = m.qdd.data() + i * m.velocities * lanes;
    m.kernel.forward(block);
  }
}

void FigureCrowd::acceleration(int figure, std::span<double> qdd) const {
  const Impl& m = *impl_;
  m.check(figure, qdd.size(), m.velocities, "qdd");
  for (std::size_t k = 0; k < qdd.size(); ++k) qdd[k] = m.qdd.data()[m.place(figure, m.velocities, k)];
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
