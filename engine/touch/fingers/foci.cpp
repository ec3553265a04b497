#include "touch/fingers/foci.hpp"

#include "touch/fingers/foci_math.hpp"
#include "touch/fingers/sections.hpp"
#include "touch/fingers/sector_borders.hpp"

namespace palpa::touch {
namespace {

static_assert(outline_bins <= foci_most);

constexpr std::uint32_t bins = outline_bins;

/// The last of the ascending borders that p has passed.
std::uint32_t sector_of(const Float2& p, std::span<const Border> borders) {
  if (p.x == 0 && p.y == 0) return 0;
  auto beyond = static_cast<std::uint32_t>(borders.size());
  std::uint32_t sector = 0;
  while (beyond - sector > 1) {
    const std::uint32_t middle = (sector + beyond) / 2;
    (reaches(p, {borders[middle].x, borders[middle].y}) ? sector : beyond) = middle;
  }
  return sector;
}

/// A finger's contacts in the plane of its cross-section.
struct Plane {
  const Finger& finger;
  const std::vector<Contact>& contacts;
  LocalOrigin local = local_origin(finger, contacts);
  PrincipalAxes axes{};
  Scaling scaling{};

  Plane(const Finger& of, const std::vector<Contact>& all) : finger(of), contacts(all) {
    const CrossSection& s = finger.section;
    const auto float3 = [](const glm::vec3& v) { return Float3{v.x, v.y, v.z}; };
    axes = {float3(s.axes[0]), float3(s.axes[1]), float3(s.axes[2]),
            s.eigenvalues[0],  s.eigenvalues[1],  s.eigenvalues[2]};
    scaling = scaling_of(axes.l1, axes.l2, s.turn.x, s.turn.y);
  }
  std::uint32_t members() const { return static_cast<std::uint32_t>(finger.contacts.size()); }
  Float3 from_centroid(std::uint32_t contact) const { return local.from_centroid(contacts[contact].position); }
  Float2 projected(const Float3& d) const { return on_plane(axes, d, scaling); }
};

/// The outline's mean radius in each bin; for an empty bin, it is interpolated between its neighbours.
std::array<float, bins> radii(const Plane& plane, std::span<const Border> directions) {
  std::array<std::int32_t, bins> sums{};
  std::array<std::uint32_t, bins> counts{};
  const float steps = radius_steps(plane.members());
  for (const std::uint32_t i : plane.finger.contacts) {
    const Float2 p = plane.projected(plane.from_centroid(i));
    const std::uint32_t bin = sector_of(p, directions);
    sums[bin] += in_steps(radius_of(p), steps);
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
    const float mean_before = mean_radius(sums[before], counts[before], steps);
    const float mean_after = mean_radius(sums[after], counts[after], steps);
    radius[m] = back == 0 ? mean_before : radius_between(mean_before, mean_after, back, on);
  }
  return radius;
}

/// Borders that cut the cross-section's outline into `foci` pieces of equal length.
std::array<Border, max_foci> equal_arcs(const Plane& plane, std::span<const Border> directions, std::uint32_t foci) {
  const std::array<float, bins> radius = radii(plane, directions);
  std::array<Float2, bins + 1> corners{};
  for (std::uint32_t m = 0; m < bins; ++m) {
    corners[m] = corner_of(radius[(m + bins - 2) % bins], radius[(m + bins - 1) % bins], radius[m],
                           radius[(m + 1) % bins], {directions[m].x, directions[m].y});
  }
  corners[bins] = corners[0];
  std::array<float, bins + 1> way{};  // length along the outline to each corner, and of the complete outline
  for (std::uint32_t m = 0; m < bins; ++m)
    way[m + 1] = way[m] + metres_between(corners[m], corners[m + 1], plane.scaling);
  std::array<Border, max_foci> borders{};
  for (std::uint32_t n = 0; n < foci; ++n) {
    const float cut = cut_at(way[bins], n, foci);
    std::uint32_t side = 0;
    while (side + 1 < bins && way[side + 1] <= cut)
      ++side;
    const Float2 at = along_side(corners[side], corners[side + 1], cut - way[side], way[side + 1] - way[side]);
    borders[n] = {at.x, at.y};
  }
  return borders;
}

void sum_sectors(Finger& finger, const Plane& plane, std::span<const Border> borders) {
  const float steps = steps_per_metre(plane.members(), plane.axes.l1, plane.axes.l2, plane.axes.l3);
  std::array<std::array<std::int32_t, 3>, max_foci> sums{};
  finger.foci.assign(borders.size(), {});
  for (const std::uint32_t i : finger.contacts) {
    const Float3 d = plane.from_centroid(i);
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
    focus.position = {focus_coordinate(origin.x, mean.x, sums[n][0], focus.points, steps),
                      focus_coordinate(origin.y, mean.y, sums[n][1], focus.points, steps),
                      focus_coordinate(origin.z, mean.z, sums[n][2], focus.points, steps)};
  }
}

}  // namespace

void find_foci(const Parameters& parameters, std::span<const std::uint32_t> of_solid, Touch& out) {
  static const std::vector<Border> every = sector_borders();
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
