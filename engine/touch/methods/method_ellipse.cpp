// The method of the paper's reference [7]: foci on an ellipse that is fitted to the contacts, projected on the plane of
// the cross-section. It does not need contacts in every direction, so it bridges skin that no camera sees. It cannot
// represent a cross-section that is not an ellipse.
#include <algorithm>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "touch/methods/ellipse.hpp"
#include "touch/methods/method.hpp"

namespace palpa::touch {
namespace {

/// The regression, unless the contacts do not determine it: a short arc may give an ellipse of any size. In that case,
/// and for fewer than 6 contacts, the ellipse of the same mean and covariance.
std::optional<Ellipse> ellipse_through(const Touch& touch, const Finger& finger, const SectionPlane& plane) {
  PlaneMoments moments;
  double farthest = 0;
  for (const std::uint32_t contact : finger.contacts) {
    const Vec2 p = plane.flat(touch.contacts[contact].position);
    moments.add(p);
    farthest = std::max(farthest, glm::length(p));
  }
  const std::optional<Ellipse> fitted = fit_ellipse(moments);
  if (fitted && fitted->semi_major() <= 2 * farthest && glm::length(fitted->centre) <= farthest) return fitted;
  return ellipse_of_moments(moments);
}

}  // namespace

void place_ellipse(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out) {
  const std::size_t foci = options.foci == 0 ? finger.foci.size() : options.foci;
  const SectionPlane plane(finger.section);
  const std::optional<Ellipse> ellipse = ellipse_through(touch, finger, plane);
  if (!ellipse) return;
  std::optional<ArcSteps> arc;
  if (options.equal_arc) arc.emplace(*ellipse);
  out.complete = true;
  out.foci.assign(foci, {});
  constexpr double turn = 2 * std::numbers::pi;
  const auto count = static_cast<double>(foci);
  for (std::size_t n = 0; n < foci; ++n) {
    // In the middle of sector n, where a cross-section's focus would lie.
    const double share = (static_cast<double>(n) + 0.5) / count;
    out.foci[n].position = plane.raised(ellipse->at(arc ? arc->parameter_at(share) : turn * share));
  }
  for (const std::uint32_t contact : finger.contacts) {
    const double t = ellipse->parameter_of(plane.flat(touch.contacts[contact].position));
    const double share = arc ? arc->share_of(t) : t / turn;
    ++out.foci[static_cast<std::size_t>(share * count) % foci].points;
  }
}

}  // namespace palpa::touch
