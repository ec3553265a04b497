#include "touch/methods/method.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/math.hpp"

namespace palpa::touch {
namespace {

/// The paper's baseline (Sec. IV-C): a single focus at the centroid of the contacts. It does not move on the skin, so
/// the schedule modulates it.
void place_single_focus(const Finger& finger, Placement& out) {
  out.foci.assign(1, {finger.section.centroid, finger.contact_count});
  out.complete = true;
}

/// All foci of the cross-section at once, as in the paper's reference [12] (Long et al. 2014), which draws an object's
/// intersection with the hand with several simultaneous foci and modulates them. The solver determines how well the
/// array makes several foci at once.
void place_multi_focus(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out) {
  place_cross_section(touch, finger, options, out);
  out.complete = false;  // an empty sector's focus would only make its neighbour louder
}

void place_by_method(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out) {
  switch (options.method) {
    case Method::cross_section:
      return place_cross_section(touch, finger, options, out);
    case Method::single_focus:
      return place_single_focus(finger, out);
    case Method::ellipse:
      return place_ellipse(touch, finger, options, out);
    case Method::multi_focus:
      return place_multi_focus(touch, finger, options, out);
  }
}

/// What a method's foci do, whatever the finger.
struct Traits {
  bool still = false, together = false;
};

Traits traits_of(Method method) {
  switch (method) {
    case Method::cross_section:
    case Method::ellipse:
      return {};
    case Method::single_focus:
      return {.still = true};
    case Method::multi_focus:
      return {.still = true, .together = true};
  }
  return {};
}

bool has_any(const Placement& placement) {
  for (std::size_t i = 0; i < placement.foci.size(); ++i) {
    if (placement.has(i)) return true;
  }
  return false;
}

}  // namespace

bool stands_still(Method method) {
  return traits_of(method).still;
}

bool sounds_together(Method method) {
  return traits_of(method).together;
}

void place_foci(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out) {
  out.foci.clear();
  out.complete = false;
  out.together = sounds_together(options.method);
  if (!finger.point_like) place_by_method(touch, finger, options, out);
  if (!has_any(out)) {
    out.together = false;
    place_single_focus(finger, out);
  }
}

double perimeter_of(const Placement& placement) {
  const Focus* first = nullptr;
  const Focus* last = nullptr;
  std::size_t corners = 0;
  double length = 0;
  const auto apart = [](const Focus& a, const Focus& b) { return glm::distance(Vec3(a.position), Vec3(b.position)); };
  for (std::size_t i = 0; i < placement.foci.size(); ++i) {
    if (!placement.has(i)) continue;
    const Focus& focus = placement.foci[i];
    if (last) length += apart(*last, focus);
    if (!first) first = &focus;
    last = &focus;
    ++corners;
  }
  if (corners < 3) return 0;
  length += apart(*last, *first);
  const double half_step = std::numbers::pi / static_cast<double>(corners);
  return length * half_step / std::sin(half_step);
}

}  // namespace palpa::touch
