#include "touch/fingers/sectors.hpp"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <vector>

#include "touch/fingers/sections.hpp"

namespace palpa::touch {
namespace {

constexpr std::uint32_t bins = 64;  ///< of an outline, at equal angles
static_assert(bins <= max_foci);

/// The direction of angle 2 pi n / N, exact if it lies on an axis.
glm::vec2 border(std::uint32_t n, std::uint32_t foci) {
  const double angle = 2 * std::numbers::pi * n / foci;
  double x = std::cos(angle), y = std::sin(angle);
  if (std::abs(x) < 1e-12) x = 0;
  if (std::abs(y) < 1e-12) y = 0;
  return {static_cast<float>(x), static_cast<float>(y)};
}

/// The borders of N sectors for every N up to max_foci, one N after the other.
std::vector<glm::vec2> sector_borders() {
  std::vector<glm::vec2> borders;
  for (std::uint32_t foci = 1; foci <= max_foci; ++foci) {
    for (std::uint32_t n = 0; n < foci; ++n)
      borders.push_back(border(n, foci));
  }
  return borders;
}

/// The index of the first border of a circle with `foci` sectors.
constexpr std::size_t first_border(std::size_t foci) {
  return foci * (foci - 1) / 2;
}

/// Eq. (5)'s scaling to equal variance and back, as symmetric matrices, for in-plane axes w1 and w2. In their
/// coordinates, the first principal direction is (cosine, sine). For the principal axes themselves, they are Eq. (5)'s
/// 1 / sqrt(l).
struct Scaling {
  float xx, xy, yy;
  float back_xx, back_xy, back_yy;
};

Scaling scaling_of(const CrossSection& section) {
  const auto [l1, l2, l3] = section.eigenvalues;
  const float cosine = section.turn.x, sine = section.turn.y;
  const float root1 = std::sqrt(l1), root2 = std::sqrt(l2);
  const float scale1 = 1 / root1, scale2 = 1 / root2;
  return {.xx = scale1 * cosine * cosine + scale2 * sine * sine,
          .xy = (scale1 - scale2) * cosine * sine,
          .yy = scale1 * sine * sine + scale2 * cosine * cosine,
          .back_xx = root1 * cosine * cosine + root2 * sine * sine,
          .back_xy = (root1 - root2) * cosine * sine,
          .back_yy = root1 * sine * sine + root2 * cosine * cosine};
}

/// Whether p's angle is at least the border's, both in [0, 2 pi).
bool reaches(const glm::vec2& p, const glm::vec2& border) {
  const auto in_second_half = [](const glm::vec2& q) { return q.y < 0 || (q.y == 0 && q.x < 0); };
  const bool second = in_second_half(p);
  return second == in_second_half(border) ? border.x * p.y - border.y * p.x >= 0 : second;
}

/// Sums are in integers, so their order does not matter.
std::int32_t in_steps(float value, float steps) {
  return static_cast<std::int32_t>(std::floor(value * steps + 0.5F));
}

/// The distance in metres between two points of the scaled plane.
float metres_between(const glm::vec2& a, const glm::vec2& b, const Scaling& scaling) {
  const float x = b.x - a.x, y = b.y - a.y;
  const float u = scaling.back_xx * x - scaling.back_xy * y;
  const float v = scaling.back_xy * x - scaling.back_yy * y;
  return std::sqrt(u * u + v * v);
}

/// The point `ahead` beyond a on the way to b; the way's length is `side`.
glm::vec2 along_side(const glm::vec2& a, const glm::vec2& b, float ahead, float side) {
  const float share = side > 0 ? ahead / side : 0;
  return a + share * (b - a);
}

/// The last of the ascending borders that p has passed.
std::uint32_t sector_of(const glm::vec2& p, std::span<const glm::vec2> borders) {
  if (p.x == 0 && p.y == 0) return 0;
  auto beyond = static_cast<std::uint32_t>(borders.size());
  std::uint32_t sector = 0;
  while (beyond - sector > 1) {
    const std::uint32_t middle = (sector + beyond) / 2;
    (reaches(p, borders[middle]) ? sector : beyond) = middle;
  }
  return sector;
}

/// A finger's contacts in the plane of its cross-section.
struct Plane {
  const Finger& finger;
  const std::vector<Contact>& contacts;
  LocalOrigin local = local_origin(finger, contacts);
  Scaling scaling;

  Plane(const Finger& of, const std::vector<Contact>& all)
      : finger(of), contacts(all), scaling(scaling_of(of.section)) {}
  std::uint32_t members() const { return static_cast<std::uint32_t>(finger.contacts.size()); }
  glm::vec3 from_centroid(std::uint32_t contact) const { return local.from_centroid(contacts[contact].position); }
  /// Eq. (5) with its second coordinate negated: angles of (x, y) run clockwise seen from the tip of w3, so y counts
  /// against w2.
  glm::vec2 projected(const glm::vec3& d) const {
    const float x = glm::dot(finger.section.axes[0], d), y = glm::dot(finger.section.axes[1], d);
    return {x * scaling.xx + y * scaling.xy, -(x * scaling.xy + y * scaling.yy)};
  }
};

/// The outline's mean radius in each bin; for an empty bin, it is interpolated between its neighbours.
std::array<float, bins> radii(const Plane& plane, std::span<const glm::vec2> directions) {
  std::array<std::int32_t, bins> sums{};
  std::array<std::uint32_t, bins> counts{};
  const float steps = 7.0e8F / static_cast<float>(plane.members());  // the sum of radii is at most sqrt(2) contacts
  for (const std::uint32_t i : plane.finger.contacts) {
    const glm::vec2 p = plane.projected(plane.from_centroid(i));
    const std::uint32_t bin = sector_of(p, directions);
    sums[bin] += in_steps(std::sqrt(p.x * p.x + p.y * p.y), steps);
    ++counts[bin];
  }
  std::array<float, bins> radius{};
  for (std::uint32_t m = 0; m < bins; ++m) {
    std::uint32_t back = 0, on = 0;
    while (counts[(m + bins - back) % bins] == 0)
      ++back;
    while (counts[(m + on) % bins] == 0)
      ++on;
    const std::uint32_t before = (m + bins - back) % bins, after = (m + on) % bins;
    const auto mean = [&](std::uint32_t bin) {
      return static_cast<float>(sums[bin]) / (static_cast<float>(counts[bin]) * steps);
    };
    radius[m] = back == 0 ? mean(m)
                          : (mean(before) * static_cast<float>(on) + mean(after) * static_cast<float>(back)) /
                                static_cast<float>(back + on);
  }
  return radius;
}

/// Borders that cut the cross-section's outline into `foci` pieces of equal length.
std::array<glm::vec2, max_foci> equal_arcs(const Plane& plane, std::span<const glm::vec2> directions,
                                           std::uint32_t foci) {
  const std::array<float, bins> radius = radii(plane, directions);
  std::array<glm::vec2, bins + 1> corners{};
  for (std::uint32_t m = 0; m < bins; ++m) {
    // A corner lies where two bins meet; its radius is smoothed over four bins.
    const float smooth =
        (radius[(m + bins - 2) % bins] + 3 * radius[(m + bins - 1) % bins] + 3 * radius[m] + radius[(m + 1) % bins]) *
        0.125F;
    corners[m] = smooth * directions[m];
  }
  corners[bins] = corners[0];
  std::array<float, bins + 1> way{};  // length along the outline to each corner, and of the complete outline
  for (std::uint32_t m = 0; m < bins; ++m)
    way[m + 1] = way[m] + metres_between(corners[m], corners[m + 1], plane.scaling);
  std::array<glm::vec2, max_foci> borders{};
  for (std::uint32_t n = 0; n < foci; ++n) {
    const float cut = way[bins] * static_cast<float>(n) / static_cast<float>(foci);
    std::uint32_t side = 0;
    while (side + 1 < bins && way[side + 1] <= cut)
      ++side;
    borders[n] = along_side(corners[side], corners[side + 1], cut - way[side], way[side + 1] - way[side]);
  }
  return borders;
}

void sum_sectors(Finger& finger, const Plane& plane, std::span<const glm::vec2> borders) {
  // As fine as 31 bits allow: the sum of all distances from the centroid is at most contacts * sqrt(l1 + l2 + l3)
  // (Cauchy-Schwarz), and stays below 2^30 steps.
  const auto [l1, l2, l3] = finger.section.eigenvalues;
  const float reach = static_cast<float>(plane.members()) * std::sqrt(l1 + l2 + l3);
  const float steps = 1.0e9F / reach;
  std::array<std::array<std::int32_t, 3>, max_foci> sums{};
  finger.foci.assign(borders.size(), {});
  for (const std::uint32_t i : finger.contacts) {
    const glm::vec3 d = plane.from_centroid(i);
    const std::uint32_t sector = sector_of(plane.projected(d), borders);
    sums[sector][0] += in_steps(d.x, steps);
    sums[sector][1] += in_steps(d.y, steps);
    sums[sector][2] += in_steps(d.z, steps);
    ++finger.foci[sector].points;
  }
  const auto& [origin, mean] = plane.local;
  for (std::size_t n = 0; n < borders.size(); ++n) {
    Focus& focus = finger.foci[n];
    if (focus.points == 0) continue;
    // The mean is the centroid relative to the origin, so that a position is rounded only once.
    const auto coordinate = [&](float from, float middle, std::int32_t sum) {
      return from + (middle + static_cast<float>(sum) / (static_cast<float>(focus.points) * steps));
    };
    focus.position = {coordinate(origin.x, mean.x, sums[n][0]), coordinate(origin.y, mean.y, sums[n][1]),
                      coordinate(origin.z, mean.z, sums[n][2])};
  }
}

}  // namespace

void find_foci(const FingerOptions& parameters, std::span<const std::uint32_t> of_solid, Touch& out) {
  static const std::vector<glm::vec2> every = sector_borders();
  for (Finger& finger : std::span(out.fingers).first(out.finger_count)) {
    finger.placed = false;
    if (finger.point_like) {
      finger.foci.assign(1, {finger.section.centroid, static_cast<std::uint32_t>(finger.contacts.size())});
      continue;
    }
    const std::uint32_t own = finger.solid < of_solid.size() ? of_solid[finger.solid] : 0;
    const std::uint32_t foci = own == 0 ? parameters.foci : own;
    const Plane plane(finger, out.contacts);
    if (parameters.spacing == Spacing::arc) {
      const auto borders = equal_arcs(plane, std::span(every).subspan(first_border(bins), bins), foci);
      sum_sectors(finger, plane, std::span(borders).first(foci));
    } else {
      sum_sectors(finger, plane, std::span(every).subspan(first_border(foci), foci));
    }
  }
}

}  // namespace palpa::touch
