// Bullet's copy of a body: what stock code reads of a btSoftBody follows the truth once a step.
#include <BulletSoftBody/btSoftBodyInternals.h>
#include <BulletSoftBody/btSoftBodySolvers.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "bullet_math.h"
#include "softpoint/core/deformable.h"
#include "softpoint/core/deformable_system.h"

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

void Deformable::build_mirror() {
  mirror_solver_ = std::make_unique<MirrorSolver>();
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

void Deformable::mirror_normals() {
  for (int i = 0; i < m_nodes.size(); ++i) {
    m_nodes[i].m_n = btVector3(0, 0, 0);
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
}

void Deformable::set_mirrored_normals(bool on) {
  if (on && !mirrored_normals_) mirror_normals();
  mirrored_normals_ = on;
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
    low = low.cwiseMin(positions_[v]);
    high = high.cwiseMax(positions_[v]);
    farthest = std::max(farthest, (positions_[v] - tree_positions_[v]).squaredNorm());
  }
  if (!(std::sqrt(farthest) < tree_padding_)) {
    fit_face_tree(kLeafPadding * (high - low).maxCoeff());
  }
  if (mirrored_normals_) mirror_normals();
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

}  // namespace softpoint::inline SOFTPOINT_ABI
