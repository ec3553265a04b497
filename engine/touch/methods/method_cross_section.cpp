// The paper's method: the centroids of the cross-section's sectors, Eq. (5)-(7). find_foci() has already
// found them. The sectors are recomputed here only for another number of foci.
#include <array>
#include <numbers>
#include <optional>

#include "touch/methods/ellipse.hpp"
#include "touch/methods/method.hpp"

namespace palpa::touch {
namespace {

/// Eq. (6)-(7) with `foci` sectors. Contacts within rounding of a border may be counted on either side of it.
void cut_sectors(const Touch& touch, const Finger& finger, std::uint32_t foci, std::vector<Focus>& out) {
  const SectionPlane plane(finger.section);
  PlaneMoments moments;
  for (const std::uint32_t contact : finger.contacts)
    moments.add(plane.flat(touch.contacts[contact].position));
  const std::optional<Ellipse> angles = ellipse_of_moments(moments);
  out.clear();
  if (!angles) return;
  const Vec3 centroid(finger.section.centroid);
  std::array<Vec3, max_foci> sums{};
  out.assign(foci, {});
  for (const std::uint32_t contact : finger.contacts) {
    const glm::vec3& p = touch.contacts[contact].position;
    const double turns = angles->parameter_of(plane.flat(p)) / (2 * std::numbers::pi);
    const std::uint32_t sector = static_cast<std::uint32_t>(turns * foci) % foci;
    sums[sector] += Vec3(p) - centroid;
    ++out[sector].points;
  }
  for (std::uint32_t n = 0; n < foci; ++n) {
    if (out[n].points != 0) out[n].position = glm::vec3(centroid + sums[n] / static_cast<double>(out[n].points));
  }
}

}  // namespace

void place_cross_section(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out) {
  if (options.foci == 0 || options.foci == finger.foci.size()) {
    out.foci = finger.foci;
    out.complete = finger.placed;
  } else {
    cut_sectors(touch, finger, options.foci, out.foci);
  }
}

}  // namespace palpa::touch
