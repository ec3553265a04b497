// The distance of the farthest transducer, without testing all of them.
#pragma once

#include <vector>

#include "array/layouts/layout.hpp"

namespace palpa::array {

/// The point of a set that is farthest from any place is a vertex of its convex hull. A board's hull has four vertices:
/// 64 for the paper's 3984 transducers. Transducers that belong to no board are all kept.
class FarthestTransducer {
 public:
  explicit FarthestTransducer(const Layout& layout);

  /// Distance of the layout's farthest transducer; 0 for an empty layout.
  double distance_from(const Vec3& place) const;
  std::size_t candidates() const { return candidates_.size(); }

 private:
  std::vector<Vec3> candidates_;
};

}  // namespace palpa::array
