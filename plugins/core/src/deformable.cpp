#include "softpoint/core/deformable.h"

#include <BulletSoftBody/btSoftBodySolvers.h>


#include <algorithm>
#include <cmath>
#include <map>

#include "bullet_math.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI {

Deformable::Deformable(std::vector<Vec3> positions, std::vector<Triangle> triangles,
                       std::vector<double> masses)
    : btSoftBody(&world_info_),
      positions_(std::move(positions)),
      masses_(std::move(masses)),
      triangles_(std::move(triangles)) {
  if (positions_.empty() || triangles_.empty()) {
    throw Error("deformable: it needs at least one point and one face");
  }
  if (masses_.size() != positions_.size()) {
    throw Error("deformable: masses has " + std::to_string(masses_.size()) +
                " entries, permitted is one per point, " + std::to_string(positions_.size()));
  }
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    check_range("deformable: mass of point " + std::to_string(i), masses_[i], kMinPointMass, kMaxPointMass);
    check_range("deformable: position of point " + std::to_string(i), positions_[i], -kMaxPosition,
                kMaxPosition);
    total_mass_ += masses_[i];
  }
  for (const Triangle& t : triangles_) {
    for (const int v : t) {
      check_index("deformable: vertex of a face", v, static_cast<long long>(positions_.size()));
    }
  }
  velocities_.assign(positions_.size(), Vec3::Zero());
  end_positions_ = free_positions_ = impulse_points_ = positions_;
  impulses_.assign(positions_.size(), Vec3::Zero());

  std::map<std::pair<int, int>, std::size_t> known;
  for (std::size_t f = 0; f < triangles_.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangles_[f][k], b = triangles_[f][(k + 1) % 3];
      const auto [entry, fresh] = known.try_emplace(std::minmax(a, b), edges_.size());
      if (fresh) {
        edges_.push_back({a, b});  // along its first face
        edge_faces_.push_back({static_cast<int>(f), -1});
      } else {
        edge_faces_[entry->second][1] = static_cast<int>(f);
      }
    }
  }
  build_mirror();
}

Deformable::~Deformable() {
  if (system_ != nullptr) {
    system_->remove(*this);
  }
}

void Deformable::change_masses(std::span<const double> masses) {
  total_mass_ = 0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    masses_[i] = masses[i];
    total_mass_ += masses[i];
    m_nodes[static_cast<int>(i)].m_im = btScalar(1.0 / masses[i]);
  }
}

void Deformable::take_impulses() {
  if (impulses_queued_) {
    for (std::size_t v = 0; v < velocities_.size(); ++v) {
      velocities_[v] += impulses_[v] / masses_[v];
      impulses_[v].setZero();
    }
    impulses_queued_ = false;
  }
}

void Deformable::begin(double dt, const Vec3& gravity) {
  step_ = dt;
  const Vec3 change = dt * (gravity + acceleration_);
  for (std::size_t v = 0; v < velocities_.size(); ++v) {
    velocities_[v] += change;
  }
  take_impulses();
  impulse_points_ = positions_;
  couple_.setZero();
  predict(dt);
  free_positions_ = end_positions_;
}

// What solves its own contact moves later; until then its ends are those of a free flight.
void Deformable::begin_own(double dt, const Vec3& gravity) {
  step_ = dt;
  take_impulses();
  const Vec3 change = dt * (gravity + acceleration_);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_positions_[v] = positions_[v] + dt * (velocities_[v] + change);
  }
}

void Deformable::predict(double dt) {
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_positions_[v] = positions_[v] + dt * velocities_[v];
  }
}

void Deformable::compliance(std::span<const int> touched, double* blocks) {
  const std::size_t n = 3 * touched.size();
  std::fill(blocks, blocks + n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    blocks[i * n + i] = 1.0 / masses_[static_cast<std::size_t>(touched[i / 3])];
  }
}

void Deformable::respond(std::span<const int> touched, std::span<const Vec3> impulses) {
  end_positions_ = free_positions_;
  for (std::size_t i = 0; i < touched.size(); ++i) {
    const auto v = static_cast<std::size_t>(touched[i]);
    end_positions_[v] += step_ * impulses[i] / masses_[v];
  }
}

void Deformable::advance_by(double, const Vec3&, NearColliders&, std::span<HeldPoint>) {}

void Deformable::commit(double dt) {
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] = (end_positions_[v] - positions_[v]) / dt;
    positions_[v] = end_positions_[v];
  }
}

void Deformable::skin_normals(std::vector<Vec3>& normals) const {
  normals.assign(end_positions_.size(), Vec3::Zero());
  for (const Triangle& t : triangles_) {
    const auto at = [&](std::size_t k) -> const Vec3& {
      return end_positions_[static_cast<std::size_t>(t[k])];
    };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    for (const int v : t) {
      normals[static_cast<std::size_t>(v)] += normal;
    }
  }
  for (Vec3& normal : normals) {
    normal.normalize();
  }
}

void Deformable::finish(double dt) {
  const bool finite = std::all_of(end_positions_.begin(), end_positions_.end(), [](const Vec3& p) {
    return p.allFinite() && p.cwiseAbs().maxCoeff() < 1e30;  // btScalar may be float
  });
  if (finite) {
    commit(dt);
    turn_by_couple();
    return;
  }
  ++guard_fired_;
  end_positions_ = free_positions_ = positions_;
  std::fill(velocities_.begin(), velocities_.end(), Vec3::Zero());
  restored();
}

void Deformable::apply_impulse(int face, const Vec3& weights, const Vec3& impulse) {
  check_index("apply_impulse: face", face, static_cast<long long>(triangles_.size()));
  check_range("apply_impulse: weights", weights, -1e-6, 1.0 + 1e-6);
  check_range("apply_impulse: sum of weights", weights.sum(), 1.0 - 1e-6, 1.0 + 1e-6);
  check_range("apply_impulse: impulse", impulse, -kMaxImpulse, kMaxImpulse);
  if (impulse.isZero(0)) {
    return;
  }
  const Triangle& t = triangles_[static_cast<std::size_t>(face)];
  for (std::size_t k = 0; k < 3; ++k) {
    queue_impulse(t[k], weights[static_cast<Eigen::Index>(k)] * impulse);
  }
  wake();
}

void Deformable::queue_impulse(int point, const Vec3& impulse) {
  impulses_[static_cast<std::size_t>(point)] += impulse;
  impulses_queued_ = true;
}

void Deformable::set_acceleration(const Vec3& acceleration) {
  check_range("set_acceleration: acceleration", acceleration, -kMaxAcceleration, kMaxAcceleration);
  if (acceleration_ != acceleration) {
    acceleration_ = acceleration;
    wake();
  }
}

int Deformable::calculateSerializeBufferSize() const {
  return btCollisionObject::calculateSerializeBufferSize();
}

const char* Deformable::serialize(void* buffer, btSerializer* serializer) const {
  return btCollisionObject::serialize(buffer, serializer);
}

}  // namespace softpoint::inline SOFTPOINT_ABI
