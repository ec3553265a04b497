// A finger seen from below, x to the right and z upwards, as a picture of values on its skin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "drawing/png.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::setup {

/// The visible square around the tip, in samples and metres.
inline constexpr std::size_t below_side = 240;
inline constexpr double below_half_m = 11e-3, below_step_m = 2 * below_half_m / below_side;

struct SeenFromBelow {
  std::vector<std::int64_t> face;  ///< for each sample, row by row from the top; -1: none
  std::vector<double> y;           ///< the height of the skin there, m

  SeenFromBelow(const geometry::Mesh& body, const Vec3& tip);

 private:
  void add(std::size_t f, const Vec3& a, const Vec3& b, const Vec3& c);
};

/// Values for each sample; NaN gets its own colour.
drawing::Pixels draw_from_below(const std::vector<double>& values, const std::string& title,
                                const std::vector<std::string>& notes, double most, const std::string& unit);

}  // namespace palpa::setup
