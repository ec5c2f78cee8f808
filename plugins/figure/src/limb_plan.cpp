#include "limb_plan.h"

#include <algorithm>

#include "lane_plan.h"
#include "lane_walk-inl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kTooHeavy = 1e200;  // kg m2: the armature of an idle lane
// A row costs more than a body alone: packs are gathered and limbs added up.
constexpr double kRowCost = 1.4;

// The bodies from the world to each leaf; none if there are joints that rows cannot hold.
std::vector<std::vector<int>> ways_of(const Tree& tree, const std::vector<std::vector<int>>& children) {
  std::vector<std::vector<int>> ways;
  int roots = 0;
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const TreeBody& body = tree.bodies[i];
    roots += body.parent < 0;
    const bool free_root = body.parent < 0 && body.joint == JointKind::kFree;
    if (!free_root && body.joint != JointKind::kHinge) return {};
    if (!children[i].empty()) continue;
    std::vector<int> way;
    for (int k = static_cast<int>(i); k >= 0; k = tree.bodies[static_cast<std::size_t>(k)].parent) {
      way.push_back(k);
    }
    ways.push_back(way);  // leaf first
  }
  if (roots != 1) return {};
  return ways;
}

}  // namespace

LimbPlan::LimbPlan(const Tree& tree, InstructionSet most) {
  const StraightBodies straight = straighten(tree);
  const std::vector<std::vector<int>> ways = ways_of(tree, straight.children);
  if (ways.size() < 2 || ways.size() > 8 || most == InstructionSet::kBaseline) return;
  LimbWalker walker;
  if (ways.size() <= 4) {
    walker = limb_walker_avx2();
  } else if (most == InstructionSet::kAvx512) {
    walker = limb_walker_avx512();
  }
  std::size_t rows = 0;
  for (const auto& way : ways) rows = std::max(rows, way.size());
  if (walker.lanes == 0 || kRowCost * static_cast<double>(rows) > static_cast<double>(tree.bodies.size())) {
    return;
  }
  walker_ = walker;
  const auto lanes = static_cast<std::size_t>(walker.lanes);

  // Who is where. Lanes without a way of their own are idle throughout but for the root, which all share.
  std::vector<std::size_t> height(tree.bodies.size(), 0);
  for (const auto& way : ways) {
    for (std::size_t n = 0; n < way.size(); ++n) {
      std::size_t& h = height[static_cast<std::size_t>(way[n])];
      h = std::max(h, n);
    }
  }
  std::vector<int> grid(rows * lanes, -1);
  const int root = ways[0].back();
  places_.resize(tree.bodies.size(), {-1, -1, 1, 0});
  for (std::size_t l = 0; l < lanes; ++l) {
    const std::vector<int> way = l < ways.size() ? ways[l] : std::vector<int>{root};
    for (const int body : way) {
      const auto i = static_cast<std::size_t>(body);
      const std::size_t row = rows - 1 - height[i];
      grid[row * lanes + l] = body;
      if (places_[i].row < 0) {
        places_[i] = {static_cast<int>(row), static_cast<int>(l), straight.twists[i].cosine,
                      straight.twists[i].sine};
      }
    }
  }

  constexpr std::size_t kNumbers = sizeof(LaneBody<double>) / sizeof(double);
  const LaneBody<double> idle{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0, {0, 0, 0}, 0, {0, 0, 0}, {0, 0, 0, 0, 0, 0}, kTooHeavy, 0};
  bodies_.resize(rows * kNumbers * lanes);
  std::vector<double> q_live, v_live;
  int dofs = 0;
  for (const TreeBody& body : tree.bodies) dofs = std::max(dofs, body.v + body.dofs);
  result_.assign(static_cast<std::size_t>(dofs), 0);
  std::vector<long long> sums;  // from and mask, of each
  sum_begins_.push_back(0);
  for (std::size_t row = 0; row < rows; ++row) {
    LaneStep step;
    step.joint = row == 0 ? tree.bodies[static_cast<std::size_t>(root)].joint : JointKind::kHinge;
    step.turn = LaneTurn::kNone;
    step.armed = step.massive = step.whirls = step.damped = false;
    step.leaf = row + 1 == rows;
    step.root = row == 0;
    step.q = static_cast<int>(q_live.size() / lanes);
    step.v = static_cast<int>(v_live.size() / lanes);
    bool first = true;
    for (std::size_t l = 0; l < lanes; ++l) {
      const int body = grid[row * lanes + l];
      LaneBody<double> constants = idle;
      LaneStep own;
      own.turn = LaneTurn::kNone;
      own.armed = own.massive = own.whirls = false;
      if (body >= 0) {
        constants = straight.bodies[static_cast<std::size_t>(body)];
        own = lane_step(tree, straight, body);
      }
      if (first) step.turn = own.turn;
      if (own.turn != step.turn) {
        const bool about_x = own.turn != LaneTurn::kGeneral && step.turn != LaneTurn::kGeneral;
        step.turn = about_x ? LaneTurn::kAboutX : LaneTurn::kGeneral;
      }
      first = false;
      step.armed |= own.armed;
      step.massive |= own.massive;
      step.whirls |= own.whirls;
      step.damped |= own.damped;
      for (std::size_t k = 0; k < kNumbers; ++k) {
        bodies_.data()[(row * kNumbers + k) * lanes + l] = reinterpret_cast<const double*>(&constants)[k];
      }
    }
    steps_.push_back(step);
    // Which numbers the row's joints have.
    const int positions = step.joint == JointKind::kFree ? 7 : 1,
              rates = step.joint == JointKind::kFree ? 6 : 1;
    for (int k = 0; k < std::max(positions, rates); ++k) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const int body = grid[row * lanes + l];
        const TreeBody* at = body < 0 ? nullptr : &tree.bodies[static_cast<std::size_t>(body)];
        if (k < positions) {
          q_index_.push_back(at == nullptr ? 0 : at->q + k);
          q_live.push_back(at == nullptr ? 0 : 1);
        }
        if (k >= rates) continue;
        if (at != nullptr && places_[static_cast<std::size_t>(body)].lane == static_cast<int>(l)) {
          result_[static_cast<std::size_t>(at->v + k)] = static_cast<int>(v_live.size());
        }
        v_index_.push_back(at == nullptr ? 0 : at->v + k);
        v_live.push_back(at == nullptr ? 0 : 1);
      }
    }
    // What hangs on each lane's body is in its own lane already but for its other children.
    for (std::size_t n = 0;; ++n) {
      bool any = false;
      std::vector<long long> from(lanes, 0), mask(lanes, 0);
      for (std::size_t l = 0; l < lanes; ++l) {
        const int body = grid[row * lanes + l];
        if (body < 0) continue;
        const auto on_own_way = [&](int child) {
          return l < ways.size() && std::find(ways[l].begin(), ways[l].end(), child) != ways[l].end();
        };
        std::size_t met = 0;
        for (const int child : straight.children[static_cast<std::size_t>(body)]) {
          if (on_own_way(child) || met++ != n) continue;
          from[l] = places_[static_cast<std::size_t>(child)].lane;
          mask[l] = -1;
          any = true;
        }
      }
      if (!any) break;
      sums.insert(sums.end(), from.begin(), from.end());
      sums.insert(sums.end(), mask.begin(), mask.end());
    }
    sum_begins_.push_back(static_cast<int>(sums.size() / (2 * lanes)));
  }
  q_live_.resize(q_live.size());
  std::copy(q_live.begin(), q_live.end(), q_live_.data());
  v_live_.resize(v_live.size());
  std::copy(v_live.begin(), v_live.end(), v_live_.data());
  sum_lanes_.resize(sums.size());
  auto* numbers = reinterpret_cast<long long*>(sum_lanes_.data());
  std::copy(sums.begin(), sums.end(), numbers);
  for (std::size_t k = 0; k < sums.size(); k += 2 * lanes) {
    sums_.push_back({numbers + k, numbers + k + lanes});
  }
  work_.resize(static_cast<std::size_t>(walker.load_size) +
               rows * static_cast<std::size_t>(walker.pose_size + walker.work_size) + q_live.size() +
               3 * v_live.size());
}

void LimbPlan::forward(const V3<double>& world, const double* q, const double* qd, const double* tau,
                       double* qdd) {
  const double acceleration[3] = {world.x, world.y, world.z};
  LimbBlock block;
  block.steps = steps_.data();
  block.rows = static_cast<int>(steps_.size());
  block.bodies = bodies_.data();
  block.sum_begins = sum_begins_.data();
  block.sums = sums_.data();
  block.q_index = q_index_.data();
  block.q_live = q_live_.data();
  block.q_packs = static_cast<int>(q_index_.size()) / walker_.lanes;
  block.v_index = v_index_.data();
  block.v_live = v_live_.data();
  block.v_packs = static_cast<int>(v_index_.size()) / walker_.lanes;
  block.result = result_.data();
  block.dofs = static_cast<int>(result_.size());
  block.world = acceleration;
  block.q = q;
  block.qd = qd;
  block.tau = tau;
  block.qdd = qdd;
  block.work = work_.data();
  walker_.forward(block);
}

void LimbPlan::unpack(std::vector<BodyWork<double>>& work) const {
  const auto lanes = static_cast<std::size_t>(walker_.lanes);
  const auto read = [&](std::size_t at, int lane, auto& to) {  // the same numbers in the same order, one lane
    double* numbers = reinterpret_cast<double*>(&to);
    for (std::size_t k = 0; k < sizeof to / sizeof(double); ++k) {
      numbers[k] = work_.data()[at + k * lanes + static_cast<std::size_t>(lane)];
    }
  };
  const auto poses = static_cast<std::size_t>(walker_.load_size);
  const std::size_t works = poses + steps_.size() * static_cast<std::size_t>(walker_.pose_size);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& place = places_[i];
    const auto row = static_cast<std::size_t>(place.row);
    M3<double> axes;  // a pose begins with them
    LaneWork<double> own;
    read(poses + row * static_cast<std::size_t>(walker_.pose_size), place.lane, axes);
    read(works + row * static_cast<std::size_t>(walker_.work_size), place.lane, own);
    BodyWork<double>& to = work[i];
    to.axes = {axes.x * place.cosine - axes.y * place.sine, axes.x * place.sine + axes.y * place.cosine,
               axes.z};
    to.arm = own.arm;
    to.reach = own.answer.reach;
    to.pivot = own.answer.pivot;
    to.push = own.answer.push;
    if (steps_[row].joint == JointKind::kFree) read(0, place.lane, to.inertia);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
