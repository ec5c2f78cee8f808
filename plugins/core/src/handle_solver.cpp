#include "handle_solver.h"

#include <Eigen/LU>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

void HandleSolver::prepare(std::span<Handle> handles, std::span<Deformable* const> bodies,
                           std::span<TouchedPoints> touched, double dt) {
  dt_ = dt;
  rows_.resize(handles.size());
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const Handle& handle = handles[h];
    TouchedPoints& points = touched[at(handle.body)];
    Row& row = rows_[h];
    row.local = points.local[at(handle.point)];
    row.inverse = (dt_ * points.compliance(row.local, row.local)).inverse();
    row.base = bodies[at(handle.body)]->free_positions_[at(handle.point)] - handle.target;
    points.spread(row.local, handle.impulse, dt_);
  }
}

double HandleSolver::sweep(std::span<Handle> handles, std::span<TouchedPoints> touched) {
  double largest = 0.0;
  for (std::size_t h = 0; h < handles.size(); ++h) {
    Handle& handle = handles[h];
    const Row& row = rows_[h];
    TouchedPoints& points = touched[at(handle.body)];
    const Vec3 error = row.base + points.displacement[at(row.local)];
    Vec3 impulse = handle.impulse - row.inverse * error;
    const double limit = handle.max_force * dt_, length = impulse.norm();
    if (length > limit) {
      impulse *= limit / length;
    }
    const Vec3 change = impulse - handle.impulse;
    handle.impulse = impulse;
    points.spread(row.local, change, dt_);
    handle.unreached = limit > length && error.norm() > 1e-5;
    largest = std::max(largest, limit > length ? error.norm() : 0.0);
  }
  return largest;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
