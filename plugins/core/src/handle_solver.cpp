#include "handle_solver.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "index.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Points solved together; more of one group are solved in turns.
constexpr std::size_t kLargestBlock = 64;
// m; a point farther from its target was not reached.
constexpr double kUnreached = 1e-5;

}  // namespace

void HandleSolver::prepare(std::span<Handle> handles, std::span<Deformable* const> bodies,
                           std::span<TouchedPoints> touched, RigidStates& rigid, double dt) {
  dt_ = dt;
  rows_.resize(handles.size());
  for (std::size_t h = 0; h < handles.size(); ++h) {
    Handle& handle = handles[h];
    const Deformable& body = *bodies[at(handle.body)];
    Row& row = rows_[h];
    row.local = touched[at(handle.body)].local[at(handle.point)];
    row.free = body.free_positions_[at(handle.point)];
    if (handle.anchored()) {
      handle.arm = body.impulse_points_[at(handle.point)] - rigid[handle.rigid].start.origin;
    }
  }
  if (!factored_) {
    group(handles, bodies.size(), rigid);
    factorize(handles, touched, rigid);
    factored_ = true;
    for (std::size_t u = 0; u < used_; ++u) {
      for (std::size_t i = 0; i < blocks_[u].members.size(); ++i) {
        if (blocks_[u].system.idle(i)) {
          handles[blocks_[u].members[i]].impulse.setZero();
        }
      }
    }
  }
  for (std::size_t h = 0; h < handles.size(); ++h) {
    if (!handles[h].own) {
      apply(handles[h], rows_[h], handles[h].impulse, touched, rigid);
    }
  }
}

// Displacement of point a over the step, from its target, per impulse of handle b.
Mat3 HandleSolver::coupling(const Handle& a, const Row& row_a, const Handle& b, const Row& row_b,
                            std::span<const TouchedPoints> touched, const RigidStates& rigid) const {
  Mat3 sum = Mat3::Zero();
  if (a.body == b.body) {
    sum = touched[at(a.body)].compliance(row_a.local, row_b.local);
  }
  if (a.anchored() && b.anchored()) {
    sum += rigid.compliance(a.rigid, a.arm, b.rigid, b.arm);
  }
  return dt_ * sum;
}

// Unlimited handles belong together when they hold one body, or bodies that are tied to one object.
void HandleSolver::group(std::span<const Handle> handles, std::size_t bodies, const RigidStates& rigid) {
  joined_.resize(bodies);
  for (std::size_t b = 0; b < bodies; ++b) {
    joined_[b] = static_cast<int>(b);
  }
  const auto root = [&](int body) {
    while (joined_[at(body)] != body) {
      body = joined_[at(body)];
    }
    return body;
  };
  const auto unlimited = [](const Handle& handle) { return std::isinf(handle.max_force) && !handle.own; };
  for (std::size_t h = 0; h < handles.size(); ++h) {
    if (!unlimited(handles[h]) || !handles[h].anchored()) {
      continue;
    }
    for (std::size_t k = 0; k < h; ++k) {
      if (unlimited(handles[k]) && handles[k].anchored() &&
          rigid.joined(handles[k].rigid, handles[h].rigid)) {
        joined_[at(root(handles[h].body))] = root(handles[k].body);
        break;
      }
    }
  }
  for (std::size_t h = 0; h < handles.size(); ++h) {
    rows_[h].group = unlimited(handles[h]) ? root(handles[h].body) : -1;
  }
}

void HandleSolver::factorize(std::span<const Handle> handles, std::span<const TouchedPoints> touched,
                             const RigidStates& rigid) {
  used_ = 0;
  const auto start = [&] {
    if (blocks_.size() == used_) {
      blocks_.emplace_back();
    }
    Block& block = blocks_[used_++];
    block.members.clear();
    return &block;
  };
  for (std::size_t b = 0; b < joined_.size(); ++b) {
    Block* block = nullptr;
    for (std::size_t h = handles.size(); h-- > 0;) {  // the newest first: of two pins on one point it holds
      if (rows_[h].group != static_cast<int>(b)) {
        continue;
      }
      if (block == nullptr || block->members.size() == kLargestBlock) {
        block = start();
      }
      block->members.push_back(h);
    }
  }
  for (std::size_t u = 0; u < used_; ++u) {
    Block& block = blocks_[u];
    const std::size_t n = block.members.size();
    block.values.resize(n);
    block.system.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t a = block.members[i];
      for (std::size_t j = 0; j <= i; ++j) {
        const std::size_t b = block.members[j];
        block.system.set(i, j, coupling(handles[a], rows_[a], handles[b], rows_[b], touched, rigid));
      }
    }
    block.system.factorize();
  }
  for (std::size_t h = 0; h < handles.size(); ++h) {
    if (rows_[h].group < 0 && !handles[h].own) {
      rows_[h].inverse = coupling(handles[h], rows_[h], handles[h], rows_[h], touched, rigid).inverse();
    }
  }
}

Vec3 HandleSolver::error(const Handle& handle, const Row& row, std::span<const TouchedPoints> touched,
                         const RigidStates& rigid) const {
  const Vec3 target = handle.anchored() ? rigid.end_point(handle.rigid, handle.target, dt_) : handle.target;
  return row.free + touched[at(handle.body)].displacement[at(row.local)] - target;
}

void HandleSolver::apply(const Handle& handle, const Row& row, const Vec3& impulse,
                         std::span<TouchedPoints> touched, RigidStates& rigid) const {
  touched[at(handle.body)].spread(row.local, impulse, dt_);
  if (handle.anchored()) {
    rigid.push(handle.rigid, -impulse, handle.arm);
  }
}

double HandleSolver::sweep(std::span<Handle> handles, std::span<TouchedPoints> touched, RigidStates& rigid) {
  double largest = 0.0;
  for (std::size_t u = 0; u < used_; ++u) {
    Block& block = blocks_[u];
    for (std::size_t i = 0; i < block.members.size(); ++i) {
      const std::size_t h = block.members[i];
      block.values[i] = error(handles[h], rows_[h], touched, rigid);
      const double distance = block.system.idle(i) ? 0.0 : block.values[i].norm();
      handles[h].unreached = distance > kUnreached;
      largest = std::max(largest, distance);
    }
    block.system.solve(block.values);
    for (std::size_t i = 0; i < block.members.size(); ++i) {
      const std::size_t h = block.members[i];
      handles[h].impulse -= block.values[i];
      apply(handles[h], rows_[h], -block.values[i], touched, rigid);
    }
  }
  for (std::size_t h = 0; h < handles.size(); ++h) {
    Handle& handle = handles[h];
    const Row& row = rows_[h];
    if (row.group >= 0 || handle.own) {
      continue;
    }
    const Vec3 off = error(handle, row, touched, rigid);
    Vec3 impulse = handle.impulse - row.inverse * off;
    const double limit = handle.max_force * dt_, length = impulse.norm();
    if (length > limit) {
      impulse *= limit / length;
    }
    const Vec3 change = impulse - handle.impulse;
    handle.impulse = impulse;
    apply(handle, row, change, touched, rigid);
    handle.unreached = limit > length && off.norm() > kUnreached;
    largest = std::max(largest, limit > length ? off.norm() : 0.0);
  }
  return largest;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
