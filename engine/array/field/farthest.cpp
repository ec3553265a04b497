#include "array/field/farthest.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace palpa::array {
namespace {

/// The corners of a flat grid that fills its bounding rectangle; all transducers for any other shape.
void add_extremes(const Board& board, std::span<const Transducer> transducers, std::vector<Vec3>& candidates) {
  const Transform T_board_layout = glm::inverse(board.T_layout_board);
  Box box;
  for (const Transducer& transducer : transducers)
    box.add(transform_point(T_board_layout, transducer.position));
  constexpr double same = 1e-9;
  std::vector<Vec3> corners;
  for (const Transducer& transducer : transducers) {
    const Vec3 p = transform_point(T_board_layout, transducer.position);
    const bool at_x = p.x - box.low.x < same || box.high.x - p.x < same;
    const bool at_y = p.y - box.low.y < same || box.high.y - p.y < same;
    if (at_x && at_y) corners.push_back(transducer.position);
  }
  if (corners.size() == 4 && box.high.z - box.low.z < same) {
    candidates.insert(candidates.end(), corners.begin(), corners.end());
  } else {
    for (const Transducer& transducer : transducers)
      candidates.push_back(transducer.position);
  }
}

}  // namespace

FarthestTransducer::FarthestTransducer(const Layout& layout) {
  const std::span<const Transducer> all(layout.transducers);
  std::size_t next = 0;
  for (const Board& board : layout.boards) {
    for (; next < board.first; ++next)
      candidates_.push_back(all[next].position);
    add_extremes(board, all.subspan(board.first, board.count), candidates_);
    next = board.first + board.count;
  }
  for (; next < all.size(); ++next)
    candidates_.push_back(all[next].position);
}

double FarthestTransducer::distance_from(const Vec3& place) const {
  double most = 0;
  for (const Vec3& candidate : candidates_) {
    const Vec3 way = candidate - place;
    most = std::max(most, glm::dot(way, way));
  }
  return std::sqrt(most);
}

}  // namespace palpa::array
