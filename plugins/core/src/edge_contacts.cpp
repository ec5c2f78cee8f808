// Edges, of shapes or of another skin, against the edges of a deformable.
#include <algorithm>
#include <cmath>

#include "contact_finder.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Edge pairs nearly parallel have no common normal worth using; their ends make vertex contacts.
constexpr double kParallelSine = 0.05;
// Slack (as a sine) in the test that a normal lies between the two faces of an edge.
constexpr double kWedgeSlack = 0.05;

struct EdgePair {
  double s = 0, t = 0;          // parameters on the other's edge and the skin's
  Vec3 normal = Vec3::UnitY();  // from the other into the skin
  double gap = 0;               // m, without margin
};

// Parameters of the mutually nearest points of the lines a + s u and b + t v; false when nearly parallel.
bool nearest_on_lines(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v, double& s, double& t) {
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double determinant = uu * vv - uv * uv;
  if (determinant <= kParallelSine * kParallelSine * uu * vv) {
    return false;
  }
  const Vec3 w = b - a;
  s = (vv * u.dot(w) - uv * v.dot(w)) / determinant;
  t = (uv * u.dot(w) - uu * v.dot(w)) / determinant;
  return true;
}

// The common normal of an edge and an edge of the skin; false when they are nearly parallel, or when features
// other than the two edges are nearest: the normal has to lie between the two faces on either side.
bool measure(const FeatureSource::Edge& edge, const Skin& skin, int skin_edge, bool at_start,
             EdgePair& pair) {
  const auto e = static_cast<std::size_t>(skin_edge);
  const std::vector<Vec3>& points = at_start ? skin.start() : skin.end();
  const Vec3 u = edge.b - edge.a;
  const Vec3& p = points[static_cast<std::size_t>(skin.edge_vertices()[e][0])];
  const Vec3 v = points[static_cast<std::size_t>(skin.edge_vertices()[e][1])] - p;
  if (!nearest_on_lines(edge.a, u, p, v, pair.s, pair.t)) {
    return false;
  }
  constexpr double kEnd = 1e-6;  // ends belong to corners and vertices
  if (pair.s < kEnd || pair.s > 1 - kEnd || pair.t < kEnd || pair.t > 1 - kEnd) {
    return false;
  }
  const Vec3 m1 = skin.face_normal(skin.edge_faces()[e][0], at_start);
  const Vec3 m2 = skin.edge_faces()[e][1] >= 0 ? skin.face_normal(skin.edge_faces()[e][1], at_start) : m1;
  pair.normal = u.cross(v).normalized();
  if (pair.normal.dot(m1 + m2) > 0.0) {
    pair.normal = -pair.normal;
  }
  const Vec3 along = v.normalized();  // edges of a skin run along their first face
  if (-pair.normal.dot(m1.cross(along)) > kWedgeSlack || -pair.normal.dot(along.cross(m2)) > kWedgeSlack) {
    return false;  // a face or a hollow edge of the skin is nearer
  }
  if (pair.normal.dot(edge.into_first) > kWedgeSlack || pair.normal.dot(edge.into_second) > kWedgeSlack) {
    return false;  // a face of the other is nearer
  }
  pair.gap = pair.normal.dot((p + pair.t * v) - (edge.a + pair.s * u));
  return true;
}

}  // namespace

void ContactFinder::find_edges(const FeatureSource& source, const RigidState& rigid, ContactTable& contacts) {
  skin();
  const double deepest = source.deepest_edge();
  // Over a step the pair may have moved as far as the bounds of both say.
  const double travel = first_ ? skin_.travel() + source.travel() : 0.0;
  const double range = reach_ + deepest + travel;
  source.edges_in(skin_.bounds().grown(range), features_);
  Contact name;
  name.body = body_index_;
  name.kind = ContactKind::edge;
  source.identify(name);
  for (const int i : features_) {
    const FeatureSource::Edge edge = source.edge(i, false);
    Bounds region = Bounds::of(edge.a);
    region.include(edge.b);
    skin_.edges().in_region(region.grown(range), [&](int skin_edge) {
      const auto& ends = skin_.edge_vertices()[static_cast<std::size_t>(skin_edge)];
      const auto v0 = static_cast<std::size_t>(ends[0]), v1 = static_cast<std::size_t>(ends[1]);
      EdgePair pair;
      double gap = 0;
      const bool apart =
          first_ && measure(source.edge(i, true), skin_, skin_edge, true, pair) && pair.gap > 0.0;
      if (apart) {
        // Follow the two points that are nearest now to the end of the step.
        const Vec3 on_skin = (1.0 - pair.t) * skin_.end()[v0] + pair.t * skin_.end()[v1];
        gap = pair.normal.dot(on_skin - (edge.a + pair.s * (edge.b - edge.a))) - margin_;
      } else {
        if (!measure(edge, skin_, skin_edge, false, pair)) {
          return;
        }
        gap = pair.gap - margin_;
        if (gap < -deepest) {
          return;
        }
      }
      if (gap > kSlackMargins * margin_) {
        return;
      }
      name.rigid_feature = i;
      name.skin_feature = skin_edge;
      Contact& contact = contacts.find_or_add(name);
      contact.count = 2;
      contact.points = {ends[0], ends[1], 0};
      contact.weights = {1.0 - pair.t, pair.t, 0.0};
      contact.normal = pair.normal;
      contact.gap = gap;
      contact.arm = (1.0 - pair.t) * skin_.impulse_points()[v0] + pair.t * skin_.impulse_points()[v1] -
                    rigid.start.origin;
      source.place_edge(i, pair.s, edge.a + pair.s * (edge.b - edge.a), contact);
      contact.seen = contact.met = true;
    });
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
