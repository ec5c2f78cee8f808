#include "contact_solver.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "index.h"

namespace softpoint::inline SOFTPOINT_ABI {

void ContactSolver::begin_step(std::span<Deformable* const> bodies, double dt) {
  dt_ = dt;
  handle_solver_.begin_step();
  touched_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    touched_[b].local.assign(bodies[b]->positions_.size(), -1);
    touched_[b].points.clear();
  }
}

void ContactSolver::collect_touched(std::span<Deformable* const> bodies, const std::vector<Contact>& contacts,
                                    const std::vector<Handle>& handles, Profile& profile) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    TouchedPoints& touched = touched_[b];
    const std::size_t before = touched.points.size();
    const auto touch = [&](int point) {
      if (touched.local[at(point)] < 0) {
        touched.local[at(point)] = 0;
        touched.points.push_back(point);
      }
    };
    for (const Contact& contact : contacts) {
      for (int k = 0; contact.body == static_cast<int>(b) && k < contact.count; ++k) {
        touch(contact.points[at(k)]);
      }
      for (int k = 0; contact.other_body == static_cast<int>(b) && k < contact.other_count; ++k) {
        touch(contact.other_points[at(k)]);
      }
    }
    for (const Handle& handle : handles) {
      if (handle.body == static_cast<int>(b) && !handle.own) {
        touch(handle.point);
      }
    }
    const std::size_t count = touched.points.size();
    if (count != before) {  // points stay touched over the passes of a step
      std::sort(touched.points.begin(), touched.points.end());
      for (std::size_t i = 0; i < count; ++i) {
        touched.local[at(touched.points[i])] = static_cast<int>(i);
      }
      StageTimer timer(profile.seconds.compliance);
      touched.blocks.resize(9 * count * count);
      bodies[b]->compliance(touched.points, touched.blocks.data());
      touched.find_parts();
    }
    touched.reference.resize(count);
    touched.displacement.assign(count, Vec3::Zero());
    touched.impulses.assign(count, Vec3::Zero());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t v = at(touched.points[i]);
      touched.reference[i] = bodies[b]->end_positions_[v] - bodies[b]->free_positions_[v];
    }
  }
}

Vec3 ContactSolver::moved(const Contact& contact, const Row& row,
                          const std::vector<Vec3> TouchedPoints::*field) const {
  const std::vector<Vec3>& values = touched_[at(contact.body)].*field;
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < at(contact.count); ++k) {
    sum += contact.weights[k] * values[at(row.local[k])];
  }
  if (contact.other_body >= 0) {
    const std::vector<Vec3>& others = touched_[at(contact.other_body)].*field;
    for (std::size_t k = 0; k < at(contact.other_count); ++k) {
      sum -= contact.other_weights[k] * others[at(row.other_local[k])];
    }
  }
  return sum;
}

void ContactSolver::add_impulse(const Contact& contact, const Row& row, const Vec3& impulse,
                                RigidStates& rigid) {
  TouchedPoints& touched = touched_[at(contact.body)];
  for (std::size_t k = 0; k < at(contact.count); ++k) {
    touched.spread(row.local[k], contact.weights[k] * impulse, dt_);
  }
  if (contact.other_body >= 0) {
    TouchedPoints& others = touched_[at(contact.other_body)];
    for (std::size_t k = 0; k < at(contact.other_count); ++k) {
      others.spread(row.other_local[k], -contact.other_weights[k] * impulse, dt_);
    }
    return;
  }
  rigid.push(contact.rigid, -impulse, contact.arm);
}

// What one deformable brings to a row: its free motion (times `sign`) and its compliance.
void ContactSolver::add_side(const Deformable& body, const TouchedPoints& touched, int count,
                             const std::array<int, 3>& points, const std::array<double, 3>& weights,
                             double sign, std::array<int, 3>& local, Row& row) {
  for (std::size_t k = 0; k < at(count); ++k) {
    const std::size_t v = at(points[k]);
    local[k] = touched.local[v];
    row.slip_base += sign * weights[k] * (body.free_positions_[v] - body.positions_[v]);
  }
  for (std::size_t i = 0; i < at(count); ++i) {
    for (std::size_t j = 0; j < at(count); ++j) {
      row.compliance += weights[i] * weights[j] * touched.compliance(local[i], local[j]);
    }
  }
}

void ContactSolver::prepare_rows(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
                                 std::vector<Handle>& handles, RigidStates& rigid) {
  rows_.resize(contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    Contact& contact = contacts[c];
    Row& row = rows_[c];
    const RigidState& other = rigid[contact.rigid];
    row.slip_base.setZero();
    row.compliance = rigid.compliance(contact.rigid, contact.arm, contact.rigid, contact.arm);
    add_side(*bodies[at(contact.body)], touched_[at(contact.body)], contact.count, contact.points,
             contact.weights, 1.0, row.local, row);
    if (contact.other_body >= 0) {
      add_side(*bodies[at(contact.other_body)], touched_[at(contact.other_body)], contact.other_count,
               contact.other_points, contact.other_weights, -1.0, row.other_local, row);
    }
    row.compliance *= dt_;
    const Vec3& n_ = contact.normal;
    row.tangent_a = n_.cross(std::abs(n_.x()) > 0.7 ? Vec3::UnitY() : Vec3::UnitX()).normalized();
    row.tangent_b = n_.cross(row.tangent_a);
    row.normal_gain = 1.0 / n_.dot(row.compliance * n_);
    Eigen::Matrix2d tangent;
    tangent << row.tangent_a.dot(row.compliance * row.tangent_a),
        row.tangent_a.dot(row.compliance * row.tangent_b), row.tangent_b.dot(row.compliance * row.tangent_a),
        row.tangent_b.dot(row.compliance * row.tangent_b);
    row.tangent_inverse = tangent.inverse();
    const double mean = 0.5 * tangent.trace();
    row.tangent_gain = 1.0 / (mean + std::sqrt(std::max(mean * mean - tangent.determinant(), 0.0)));
    // The gap was measured with the positions and velocities of the last detection; count from the free end.
    row.gap_base = contact.gap - n_.dot(moved(contact, row, &TouchedPoints::reference) -
                                        dt_ * other.velocity_of(contact.arm));
  }
  // Only now start from the impulses themselves: features and weights may have changed since they acted.
  rigid.restart();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    Contact& contact = contacts[c];
    const double push = std::max(contact.normal.dot(contact.impulse), 0.0);
    if (!contact.seen || push == 0.0) {
      contact.impulse.setZero();
      continue;
    }
    contact.impulse = in_cone(contact, contact.impulse);  // the normal may have turned
    add_impulse(contact, rows_[c], contact.impulse, rigid);
  }
  handle_solver_.prepare(handles, bodies, touched_, rigid, dt_);
}

// Each of two deformables takes the torque of their impulse where its own skin is touched. Those places
// differ by the gap and by what elasticity has still to give, so that a couple is missing: the two share it
// by their masses, as if the impulse acted at one point between them.
void ContactSolver::balance_torques(std::span<Deformable* const> bodies,
                                    const std::vector<Contact>& contacts) {
  for (Deformable* body : bodies) {
    body->couple_.setZero();
  }
  for (const Contact& contact : contacts) {
    if (contact.other_body < 0 || contact.impulse == Vec3::Zero()) {
      continue;
    }
    Deformable& body = *bodies[at(contact.body)];
    Deformable& other = *bodies[at(contact.other_body)];
    Vec3 apart = Vec3::Zero();
    for (std::size_t k = 0; k < at(contact.count); ++k) {
      apart += contact.weights[k] * body.impulse_points_[at(contact.points[k])];
    }
    for (std::size_t k = 0; k < at(contact.other_count); ++k) {
      apart -= contact.other_weights[k] * other.impulse_points_[at(contact.other_points[k])];
    }
    const Vec3 missing = contact.impulse.cross(apart);
    const double share = body.total_mass_ / (body.total_mass_ + other.total_mass_);
    body.couple_ += share * missing;
    other.couple_ += (1.0 - share) * missing;
  }
}

void ContactSolver::move_all(std::span<Deformable* const> bodies, const std::vector<Contact>& contacts,
                             RigidStates& rigid) {
  rigid.integrate(dt_);
  balance_torques(bodies, contacts);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!touched_[b].points.empty()) {
      bodies[b]->respond(touched_[b].points, touched_[b].impulses);
    }
  }
}

void ContactSolver::warm_start(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
                               std::vector<Handle>& handles, SupportContacts& support, RigidStates& rigid,
                               Profile& profile) {
  collect_touched(bodies, contacts, handles, profile);
  StageTimer timer(profile.seconds.solve);
  prepare_rows(bodies, contacts, handles, rigid);
  support.reapply(rigid);
  move_all(bodies, contacts, rigid);
}

void ContactSolver::solve(std::span<Deformable* const> bodies, std::vector<Contact>& contacts,
                          std::vector<Handle>& handles, SupportContacts& support, RigidStates& rigid,
                          const ContactSettings& settings, Profile& profile) {
  collect_touched(bodies, contacts, handles, profile);
  StageTimer timer(profile.seconds.solve);
  prepare_rows(bodies, contacts, handles, rigid);
  support.reapply(rigid);
  for (int i = 0; i < settings.max_iterations; ++i) {
    double change = sweep_contacts(contacts, rigid);
    // A handle is to be exact, so it is asked for ten times more than a contact.
    change = std::max(change, 10.0 * handle_solver_.sweep(handles, touched_, rigid));
    change = std::max(change, support.sweep(rigid, dt_));
    ++profile.counts.iterations;
    profile.counts.residual = change;
    if (change < settings.tolerance) {
      break;
    }
  }
  move_all(bodies, contacts, rigid);
}

}  // namespace softpoint::inline SOFTPOINT_ABI
