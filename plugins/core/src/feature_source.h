#pragma once

#include <vector>

#include "contact.h"
#include "skin.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Corners and edges that may press into a skin: those of a placed rigid shape or of another skin. World
// frame throughout.
class FeatureSource {
 public:
  virtual ~FeatureSource() = default;

  struct Corner {
    Vec3 start, end;  // m, over the step
  };
  struct Edge {
    Vec3 a, b;
    Vec3 into_first,
        into_second;  // unit directions from the edge into its two faces; zero where there is none
  };

  // Indices (ascending) of the features that may meet `region` at the end of the step.
  virtual void corners_in(const Bounds& region, std::vector<int>& out) const = 0;
  virtual void edges_in(const Bounds& region, std::vector<int>& out) const = 0;
  virtual Corner corner(int index) const = 0;
  virtual Edge edge(int index, bool at_start) const = 0;
  // The unit direction in which a corner presses against a skin with this smooth normal, `outward` being the
  // way out of the skin; zero where the corner lies in a hollow and cannot press.
  virtual Vec3 press_direction(int corner, const Vec3& skin_normal, const Vec3& outward) const = 0;
  // Farthest any feature moves over the step (m).
  virtual double travel() const = 0;
  // Edges that lie deeper than this (m) without having come from outside are not what touches first.
  virtual double deepest_edge() const = 0;

  // Fills in whom a contact is with, apart from the feature's index.
  virtual void identify(Contact& contact) const = 0;
  // Fills in where it acts: the end point `at_end` of a corner, or of an edge at parameter `along`.
  virtual void place_corner(int corner, Contact& contact) const = 0;
  virtual void place_edge(int edge, double along, const Vec3& at_end, Contact& contact) const = 0;
};

class RigidFeatures final : public FeatureSource {
 public:
  RigidFeatures(const ShapeInstance& instance, const RigidState& rigid);

  void corners_in(const Bounds& region, std::vector<int>& out) const override;
  void edges_in(const Bounds& region, std::vector<int>& out) const override;
  Corner corner(int index) const override;
  Edge edge(int index, bool at_start) const override;
  Vec3 press_direction(int corner, const Vec3& skin_normal, const Vec3& outward) const override;
  double travel() const override { return (end_.origin - start_.origin).norm(); }
  double deepest_edge() const override;
  void identify(Contact& contact) const override;
  void place_corner(int corner, Contact& contact) const override;
  void place_edge(int edge, double along, const Vec3& at_end, Contact& contact) const override;

 private:
  const ShapeInstance& instance_;
  const ColliderShape& shape_;
  const RigidState& rigid_;
  Pose start_, end_;  // of the shape
};

// Vertices and edges of another deformable's skin.
class SkinFeatures final : public FeatureSource {
 public:
  // `rigid` is the index of the deformable's place-holder among the rigid states.
  SkinFeatures(const Skin& skin, int body_index, int rigid, int shape_index)
      : skin_(skin), body_index_(body_index), rigid_(rigid), shape_index_(shape_index) {}

  void corners_in(const Bounds& region, std::vector<int>& out) const override;
  void edges_in(const Bounds& region, std::vector<int>& out) const override;
  Corner corner(int index) const override;
  Edge edge(int index, bool at_start) const override;
  Vec3 press_direction(int corner, const Vec3& skin_normal, const Vec3& outward) const override;
  double travel() const override { return skin_.travel(); }
  double deepest_edge() const override;
  void identify(Contact& contact) const override;
  void place_corner(int corner, Contact& contact) const override;
  void place_edge(int edge, double along, const Vec3& at_end, Contact& contact) const override;

 private:
  const Skin& skin_;
  int body_index_;
  int rigid_;
  int shape_index_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
