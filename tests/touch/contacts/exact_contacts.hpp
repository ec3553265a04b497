// The contacts that Eq. (1) gives in double precision.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/parts/parts.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {

/// Metres within which single precision may decide either way.
inline constexpr double band = 1e-6;

/// The depth of points below the surface of a convex solid or of a solid of parts.
class ExactDepth {
 public:
  explicit ExactDepth(const geometry::Solid& solid);
  double operator()(const Vec3& point) const;

 private:
  const geometry::Solid* solid_;
  geometry::UnionSurface surface_;
};

/// Every point that double precision decides by more than the band is decided the same way, with the same depth and
/// solid. Contacts have the order of their points. Returns the number of contacts that are decided.
std::size_t expect_contacts(const Touch& touch, const std::vector<glm::vec3>& points,
                            const std::vector<geometry::Solid>& solids, double delta);

}  // namespace palpa::touch::test
