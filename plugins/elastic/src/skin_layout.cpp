#include "skin_layout.h"

#include <algorithm>
#include <array>

namespace softpoint::inline SOFTPOINT_ABI::elastic {

SkinLayout lay_out_skin(const PlacedDesign& placed) {
  SkinLayout skin;
  // First by joint and by segment, then renamed: seen ones first, in order of first use.
  std::vector<int> first_of_joint;
  int count = 0;
  std::vector<Vec3> rest;
  for (const PlacedJoint& joint : placed.joints) {
    first_of_joint.push_back(count);
    count += static_cast<int>(joint.rest.size());
    rest.insert(rest.end(), joint.rest.begin(), joint.rest.end());
  }
  const int joint_points = count;
  std::vector<std::array<int, 3>> seen;
  for (std::size_t s = 0; s < placed.segments.size(); ++s) {
    const PlacedSegment& segment = placed.segments[s];
    const TriangleMesh& mesh = segment.model->mesh;
    std::vector<int> point(mesh.vertices.size(), -1), covered(mesh.vertices.size(), -1);
    for (std::size_t i = 0; i < segment.joint.size(); ++i) {
      const int j = segment.joint[i];
      const PlacedJoint& joint = placed.joints[static_cast<std::size_t>(j)];
      const auto side =
          static_cast<std::size_t>(std::find(joint.interfaces.begin(), joint.interfaces.end(),
                                             std::array<int, 2>{static_cast<int>(s), static_cast<int>(i)}) -
                                   joint.interfaces.begin());
      const std::vector<int>& vertices = segment.model->interfaces[i];
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        const auto v = static_cast<std::size_t>(vertices[k]);
        point[v] = first_of_joint[static_cast<std::size_t>(j)] + joint.order[side][k];
        if (joint.interfaces.size() == 2) covered[v] = j;
      }
    }
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (point[v] >= 0) continue;
      point[v] = count++;
      rest.push_back(segment.rotation * mesh.vertices[v] + segment.origin);
    }
    for (const Triangle& t : mesh.triangles) {
      const auto at = [&](const std::vector<int>& of, std::size_t k) {
        return of[static_cast<std::size_t>(t[k])];
      };
      const bool inside =
          at(covered, 0) >= 0 && at(covered, 0) == at(covered, 1) && at(covered, 0) == at(covered, 2);
      if (!inside) seen.push_back({at(point, 0), at(point, 1), at(point, 2)});
    }
    skin.point_of.push_back(std::move(point));
  }
  // Points of joints that are seen, then the free vertices of each segment in a row, then what is hidden.
  std::vector<char> used(static_cast<std::size_t>(count), 0);
  for (const auto& t : seen) {
    for (const int p : t) used[static_cast<std::size_t>(p)] = 1;
  }
  const auto of_joints = static_cast<std::size_t>(joint_points);
  std::vector<int> name(static_cast<std::size_t>(count), -1);
  for (std::size_t p = 0; p < of_joints; ++p) {
    if (used[p] != 0) name[p] = skin.visible++;
  }
  for (std::size_t s = 0; s < placed.segments.size(); ++s) {
    skin.first_free.push_back(skin.visible);
    for (const int v : placed.segments[s].model->free_vertices) {
      name[static_cast<std::size_t>(skin.point_of[s][static_cast<std::size_t>(v)])] = skin.visible++;
    }
  }
  int hidden = skin.visible;
  for (int& n : name) n = n < 0 ? hidden++ : n;
  skin.rest.resize(static_cast<std::size_t>(count));
  for (std::size_t p = 0; p < rest.size(); ++p) skin.rest[static_cast<std::size_t>(name[p])] = rest[p];
  for (const auto& t : seen) {
    skin.faces.push_back({name[static_cast<std::size_t>(t[0])], name[static_cast<std::size_t>(t[1])],
                          name[static_cast<std::size_t>(t[2])]});
  }
  for (std::vector<int>& points : skin.point_of) {
    for (int& p : points) p = name[static_cast<std::size_t>(p)];
  }
  return skin;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
