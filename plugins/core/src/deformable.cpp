#include "softpoint/core/deformable.h"

#include <BulletSoftBody/btSoftBodyInternals.h>
#include <BulletSoftBody/btSoftBodySolvers.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "bullet_math.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// What a stock collision algorithm finds behind a deformable should our own collision functions be
// bypassed: it records nothing and moves nothing.
class MirrorSolver final : public btSoftBodySolver {
 public:
  SolverTypes getSolverType() const override { return DEFAULT_SOLVER; }
  bool checkInitialized() override { return true; }
  void optimize(btAlignedObjectArray<btSoftBody*>&, bool) override {}
  void copyBackToSoftBodies(bool) override {}
  void predictMotion(btScalar) override {}
  void solveConstraints(btScalar) override {}
  void updateSoftBodies() override {}
  void processCollision(btSoftBody*, const btCollisionObjectWrapper*) override {}
  void processCollision(btSoftBody*, btSoftBody*) override {}
};

// Bullet disables objects whose bounds have a diagonal of 1e6 or more.
constexpr double kLargestHalfExtent = 2.5e5;
// Face-tree leaves are padded by this part of the body's size, so that they seldom move.
constexpr double kLeafPadding = 0.05;

// Bullet's node and face leave their members uninitialised.
template <class T>
T zeroed() {
  T value;
  std::memset(static_cast<void*>(&value), 0, sizeof value);
  return value;
}

btDbvtVolume volume_of(const btSoftBody::Face& face) {
  const btVector3* points[] = {&face.m_n[0]->m_x, &face.m_n[1]->m_x, &face.m_n[2]->m_x};
  return btDbvtVolume::FromPoints(points, 3);
}

}  // namespace

Deformable::Deformable(std::vector<Vec3> positions, std::vector<Triangle> triangles,
                       std::vector<double> masses)
    : btSoftBody(&world_info_),
      positions_(std::move(positions)),
      masses_(std::move(masses)),
      triangles_(std::move(triangles)),
      mirror_solver_(std::make_unique<MirrorSolver>()) {
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

void Deformable::build_mirror() {
  m_softBodySolver = mirror_solver_.get();
  m_cfg.collisions = 0;
  getCollisionShape()->setMargin(0);
  getCollisionShape()->setUserPointer(this);  // the stock GUI helper draws what it finds here
  Material* material = appendMaterial();
  const auto count = static_cast<int>(positions_.size());
  m_nodes.resize(count, zeroed<Node>());
  m_X.resize(count, btVector3(0, 0, 0));
  for (int i = 0; i < count; ++i) {
    Node& node = m_nodes[i];
    node.m_material = material;
    node.m_im = btScalar(1.0 / masses_[static_cast<std::size_t>(i)]);
    node.index = i;
    node.m_x = node.m_q = m_X[i] = to_bullet(positions_[static_cast<std::size_t>(i)]);
    node.m_effectiveMass.setIdentity();
    node.m_effectiveMass_inv.setIdentity();
  }
  m_faces.resize(static_cast<int>(triangles_.size()), zeroed<Face>());
  for (int f = 0; f < m_faces.size(); ++f) {
    Face& face = m_faces[f];
    face.m_material = material;
    for (std::size_t k = 0; k < 3; ++k) {
      face.m_n[k] = &m_nodes[triangles_[static_cast<std::size_t>(f)][k]];
    }
    face.m_ra = AreaOf(face.m_n[0]->m_x, face.m_n[1]->m_x, face.m_n[2]->m_x);
    face.m_index = f;
    // Stock initializeFaceTree is quadratic and never returns on meshes without links.
    face.m_leaf = m_fdbvt.insert(volume_of(face), &face);
  }
  m_fdbvt.optimizeTopDown();
  // From the root down, then turned round: the tree keeps this shape, only its boxes follow.
  if (m_fdbvt.m_root != nullptr && m_fdbvt.m_root->isinternal()) {
    tree_nodes_.push_back(m_fdbvt.m_root);
  }
  for (std::size_t i = 0; i < tree_nodes_.size(); ++i) {
    for (btDbvtNode* child : {tree_nodes_[i]->childs[0], tree_nodes_[i]->childs[1]}) {
      if (child->isinternal()) {
        tree_nodes_.push_back(child);
      }
    }
  }
  std::reverse(tree_nodes_.begin(), tree_nodes_.end());
  tree_positions_ = positions_;
  tree_padding_ = -1.0;
  mirror(0.0);
}

// Boxes of faces and of what holds them, padded so that they hold for some steps. Bullet's own update takes
// leaves out of the tree and puts them back one by one.
void Deformable::fit_face_tree(double padding) {
  const btVector3 pad(static_cast<btScalar>(padding), static_cast<btScalar>(padding),
                      static_cast<btScalar>(padding));
  for (int f = 0; f < m_faces.size(); ++f) {
    Face& face = m_faces[f];
    face.m_leaf->volume = volume_of(face);
    face.m_leaf->volume.Expand(pad);
  }
  for (btDbvtNode* node : tree_nodes_) {
    Merge(node->childs[0]->volume, node->childs[1]->volume, node->volume);
  }
  tree_positions_ = positions_;
  tree_padding_ = padding;
}

void Deformable::mirror(double dt) {
  Vec3 low = positions_.front(), high = low;
  double farthest = 0;
  for (int i = 0; i < m_nodes.size(); ++i) {
    const auto v = static_cast<std::size_t>(i);
    Node& node = m_nodes[i];
    node.m_q = node.m_x;
    node.m_x = to_bullet(positions_[v]);
    node.m_v = to_bullet(velocities_[v]);
    node.m_n = btVector3(0, 0, 0);
    low = low.cwiseMin(positions_[v]);
    high = high.cwiseMax(positions_[v]);
    farthest = std::max(farthest, (positions_[v] - tree_positions_[v]).squaredNorm());
  }
  if (!(std::sqrt(farthest) < tree_padding_)) {
    fit_face_tree(kLeafPadding * (high - low).maxCoeff());
  }
  for (int f = 0; f < m_faces.size(); ++f) {
    Face& face = m_faces[f];
    const btVector3 normal =
        btCross(face.m_n[1]->m_x - face.m_n[0]->m_x, face.m_n[2]->m_x - face.m_n[0]->m_x);
    for (Node* node : face.m_n) {
      node->m_n += normal;  // area-weighted
    }
    const btScalar length = normal.length();
    face.m_normal = length > 0 ? normal / length : normal;
  }
  for (int i = 0; i < m_nodes.size(); ++i) {
    const btScalar length = m_nodes[i].m_n.length();
    if (length > 0) {
      m_nodes[i].m_n /= length;
    }
  }
  // The bounds reach over the coming step, so that whatever it meets is reported before it is met.
  const double reach = system_ != nullptr ? 2.0 * system_->settings().margin : 0.0;
  const Vec3 g =
      acceleration_ + (system_ != nullptr ? from_bullet(system_->world().getGravity()) : Vec3::Zero());
  const Vec3 fall = dt * dt * g;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 ahead = positions_[v] + dt * velocities_[v] + fall;
    low = low.cwiseMin(ahead);
    high = high.cwiseMax(ahead);
  }
  const Vec3 middle = 0.5 * (low + high);
  const Vec3 half = (0.5 * (high - low)).array() + reach;
  const Vec3 permitted = half.cwiseMin(kLargestHalfExtent);
  m_bounds[0] = to_bullet(middle - permitted);
  m_bounds[1] = to_bullet(middle + permitted);
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
