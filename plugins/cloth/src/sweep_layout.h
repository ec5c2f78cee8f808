#pragma once

#include <span>
#include <vector>

#include "softpoint/cloth/pattern.h"
#include "sweep_data.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// The ring of a grid's point: east first, counter-clockwise.
inline constexpr int kEast[8] = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr int kNorth[8] = {0, 1, 1, 1, 0, -1, -1, -1};
// The neighbours that bending over two cells may reach.
inline constexpr int kBendEast[12] = {1, 0, -1, 0, 2, 0, -2, 0, 1, -1, -1, 1};
inline constexpr int kBendNorth[12] = {0, 1, 0, -1, 0, 2, 0, -2, 1, 1, -1, -1};

// Where the points of a pattern lie in memory: by colour, so that no spring, face or bending element of a
// mesh joins two points of one colour (on a grid, bending over two cells does). A grid of four colours keeps
// the distance from a point to each of its neighbours constant within a colour.
struct SweepLayout {
  // Throws Error for a point with more neighbours than kMaxRing or kMaxBendRing.
  explicit SweepLayout(const ClothPattern& pattern);

  int slots = 0;
  std::vector<int> slot_of, point_of;  // by point; by slot, -1 where there is none
  std::vector<ColourPlan> colours;
  std::vector<int>
      volume_colours;  // each face has exactly one corner in these; empty: sum over all and take a third
  std::vector<int> spring_of;       // [tile][ring][kTile] of all colours: the spring, or -1
  std::vector<int> face_of;         // [tile][faces][kTile]: the face, or -1
  std::vector<double> bend_weight;  // [tile][bends][kTile]: entry of B
  long spring_size = 0;             // of the array [tile][ring][4][kTile]

 private:
  struct Link {
    int to;      // point, or -1
    int spring;  // or -1
  };
  struct Corner {
    int j, k, face;  // within the links
  };
  struct Node {
    std::vector<Link> links;
    std::vector<Corner> faces;
    std::vector<std::pair<int, double>> bends;
  };

  bool lay_grid(const ClothPattern& pattern, std::vector<Node>& nodes);
  void lay_mesh(const ClothPattern& pattern, std::vector<Node>& nodes);
  void fill(const std::vector<Node>& nodes, bool grid, int stride);
  void find_volume_colours(const ClothPattern& pattern);

  std::vector<std::vector<int>> numbers_;        // what the plans point to
  std::vector<std::vector<signed char>> pairs_;  //
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
