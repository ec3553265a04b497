// The distance of the farthest transducer, without asking all of them.
#pragma once

#include <vector>

#include "array/layout.hpp"

namespace palpa::array {

/// The point of a set that is farthest from anywhere is a vertex of its convex hull. A board's hull has four: 64 of the
/// paper's 3984. Transducers that belong to no board are all kept.
class Reach {
 public:
  explicit Reach(const Layout& layout);

  /// Distance of the layout's farthest transducer; 0 for an empty layout.
  double farthest(const Vec3& from) const;
  std::size_t candidates() const { return candidates_.size(); }

 private:
  std::vector<Vec3> candidates_;
};

}  // namespace palpa::array
