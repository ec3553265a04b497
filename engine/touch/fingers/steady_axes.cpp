#include "touch/fingers/steady_axes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>

#include "touch/fingers/sections.hpp"

namespace palpa::touch {
namespace {

constexpr float clear_below = 0.15F;       // l3 / l2 of a cross-section whose contacts alone show where it faces,
constexpr float unclear_above = 0.5F;      // and of one for which depth shows it
constexpr float facing_s = 0.15F;          // how slowly w3 settles in that case
constexpr float steep = 0.1F;              // a gradient of depth that is reliable
constexpr float round_below = 0.1F;        // (l1 - l2) / (l1 + l2) of a cross-section without a preferred direction
constexpr float long_above = 0.5F;         // of one whose axes are the principal axes
constexpr float settling_s = 0.1F;         // how slowly axes settle half way between the two
constexpr float most_turn_per_s = 5.0F;    // radians; for w3, and for w1 in the plane
constexpr float most_turn_at_once = 0.7F;  // sine of the turn of w1 in one frame

glm::vec3 nearer(const glm::vec3& axis, const glm::vec3& before) {
  return glm::dot(axis, before) < 0 ? -axis : axis;
}

/// `axis` without its part along the unit vector `normal`.
glm::vec3 across(const glm::vec3& axis, const glm::vec3& normal) {
  return axis - normal * glm::dot(axis, normal);
}

/// The depth's gradient over the contacts: that of the linear function that fits their depths best. On a plane,
/// whatever part of it is touched, it is the plane's normal, of length 1. On several faces, it lies between their
/// normals.
glm::vec3 depth_gradient(const CrossSection& s) {
  const auto part = [&](std::size_t k) {
    const float slope = glm::dot(s.axes[k], s.lean) / (s.eigenvalues[k] + 1.0e-8F);  // 0.1 mm gives no gradient
    return s.axes[k] * slope;
  };
  return part(0) + part(1) + part(2);
}

/// How clearly the contacts alone show where a cross-section faces: 1 if they have a thinnest direction, 0 if two
/// eigenvalues are close.
float clearness_of(const CrossSection& s) {
  const auto [l1, l2, l3] = s.eigenvalues;
  const float thickness = l2 > 0 ? l3 / l2 : 0;
  return std::clamp((unclear_above - thickness) / (unclear_above - clear_below), 0.0F, 1.0F);
}

/// The direction in which a cross-section faces that faced `before`: the principal w3 if it is clear, else the depth's
/// gradient. If depth hardly changes with place, the direction stays as before.
glm::vec3 facing_of(const CrossSection& principal, const glm::vec3& before) {
  const float clear = clearness_of(principal);
  const glm::vec3 w3 = nearer(principal.axes[2], before);
  if (clear >= 1) return w3;
  const glm::vec3 gradient = nearer(depth_gradient(principal), before);
  const float length = glm::length(gradient);
  const float trust = std::min(length / steep, 1.0F);
  const glm::vec3 by_depth = before * (1 - trust) + gradient * (length > 0 ? trust / length : 0);
  const glm::vec3 facing = w3 * clear + by_depth * (1 - clear);
  return glm::dot(facing, facing) > 1.0e-6F ? glm::normalize(facing) : before;
}

/// In a cross-section's plane: the variances along its principal directions, and the first direction in coordinates of
/// two axes, x >= 0.
struct InPlane {
  float l1, l2;
  glm::vec2 first{1, 0};
};

InPlane principal_in_plane(const glm::mat3& covariance, const glm::vec3& w1, const glm::vec3& w2) {
  const glm::vec3 m1 = covariance * w1, m2 = covariance * w2;
  const float xx = glm::dot(w1, m1), xy = glm::dot(w1, m2), yy = glm::dot(w2, m2);
  const float middle = 0.5F * (xx + yy), apart = 0.5F * (xx - yy);
  const float radius = std::sqrt(apart * apart + xy * xy);
  const float l1 = middle + radius;
  InPlane r{l1, std::max(1.0e-6F * l1, middle - radius)};  // as for fingers that are points
  if (!(radius > 0)) return r;
  // Cosine and sine are of twice the angle.
  const float cosine2 = apart / radius, sine2 = xy / radius;
  if (cosine2 >= 0) {
    r.first.x = std::sqrt(0.5F * (1.0F + cosine2));
    r.first.y = 0.5F * sine2 / r.first.x;
  } else {
    const float sine = std::sqrt(0.5F * (1.0F - cosine2));
    r.first = {0.5F * std::abs(sine2) / sine, sine2 < 0 ? -sine : sine};
  }
  return r;
}

float variance_along(const glm::mat3& covariance, const glm::vec3& w3) {
  return std::max(0.0F, glm::dot(w3, covariance * w3));
}

/// A plane with two axes in it, and a cross-section's contacts in it.
struct FacingPlane {
  glm::mat3 covariance;
  glm::vec3 w3, w1, w2;
  InPlane contacts;

  FacingPlane(const CrossSection& principal, const glm::vec3& normal, const glm::vec3& in_plane)
      : covariance(covariance_of(principal)),
        w3(normal),
        w1(in_plane),
        w2(glm::cross(normal, in_plane)),
        contacts(principal_in_plane(covariance, w1, w2)) {}
  glm::vec3 at(const glm::vec2& place) const { return w1 * place.x + w2 * place.y; }
};

/// The axes of the plane; w1 is the plane's turned by (cosine, sine).
void take_axes_across(CrossSection& section, const FacingPlane& plane, const glm::vec2& turn) {
  auto& [w1, w2, w3] = section.axes;
  w3 = plane.w3;
  w1 = glm::normalize(across(plane.at(turn), w3));
  w2 = glm::cross(w3, w1);
  section.eigenvalues = {plane.contacts.l1, plane.contacts.l2, variance_along(plane.covariance, w3)};
  const glm::vec3 first = plane.at(plane.contacts.first);
  section.turn = glm::normalize(glm::vec2(glm::dot(first, w1), glm::dot(first, w2)));
}

/// `old` turned towards a direction by a share of the angle, at most by most_turn_per_s.
glm::vec3 turned_towards(const glm::vec3& old, const glm::vec3& direction, float share, float frame_s) {
  const glm::vec3 way = direction - old;
  const float chord = glm::length(way), wanted = share * chord, most = most_turn_per_s * frame_s;
  return glm::normalize(old + way * (wanted > most ? most / chord : share));
}

/// How far w1 turns in a frame towards the principal direction: 0 to 1.
float share_of_turn(const InPlane& contacts, float frame_s) {
  const float sum = contacts.l1 + contacts.l2;
  const float elongation = sum > 0 ? (contacts.l1 - contacts.l2) / sum : 0;
  const float beyond = frame_s * (elongation - round_below);
  if (elongation <= round_below || !(beyond > 0)) return 0;
  return elongation >= long_above ? 1 : beyond / (beyond + settling_s * (long_above - elongation));
}

/// The turn of w1 in a frame, as cosine and sine.
glm::vec2 turn_in_plane(const InPlane& contacts, float frame_s) {
  const float share = share_of_turn(contacts, frame_s);
  const float ahead = 1 - share + share * contacts.first.x, aside = share * contacts.first.y;
  const float chord = std::sqrt(ahead * ahead + aside * aside), sine = aside / chord;
  const float most = std::min(most_turn_per_s * frame_s, most_turn_at_once);
  if (std::abs(sine) <= most) return {ahead / chord, sine};
  return {std::sqrt(1 - most * most), sine < 0 ? -most : most};
}

}  // namespace

glm::mat3 covariance_of(const CrossSection& section) {
  const auto scaled = [&](std::size_t k) { return section.eigenvalues[k] * section.axes[k]; };
  const auto squares = [&](std::size_t k) { return scaled(k) * section.axes[k]; };
  const auto products = [&](std::size_t k) {
    const glm::vec3 s = scaled(k), w = section.axes[k];
    return glm::vec3(s.x, s.x, s.y) * glm::vec3(w.y, w.z, w.z);
  };
  const glm::vec3 variance = squares(0) + squares(1) + squares(2), p = products(0) + products(1) + products(2);
  return {{variance.x, p.x, p.y}, {p.x, variance.y, p.z}, {p.y, p.z, variance.z}};
}

void take_first_axes(CrossSection& section) {
  if (clearness_of(section) >= 1) return;
  const auto [w1, w2, before] = section.axes;
  const glm::vec3 w3 = upwards(facing_of(section, before));
  glm::vec3 carried = across(w1, w3);
  if (glm::dot(carried, carried) < 1.0e-4F) carried = across(w2, w3);
  const FacingPlane plane(section, w3, glm::normalize(carried));
  const glm::vec2 first = plane.contacts.first;
  take_axes_across(section, plane, largest_component(plane.at(first)) < 0 ? -first : first);
}

void take_steady_axes(CrossSection& section, const glm::vec3& old1, const glm::vec3& old3, float frame_s) {
  const float slowness = facing_s * (1 - clearness_of(section));
  const float settling = slowness > 0 ? frame_s / (frame_s + slowness) : 1;
  const glm::vec3 w3 = turned_towards(old3, facing_of(section, old3), settling, frame_s);
  const float factor = -(glm::dot(w3, old1) / (1 + glm::dot(w3, old3)));
  const glm::vec3 carried = old1 + (w3 + old3) * factor;
  const FacingPlane plane(section, w3, glm::normalize(across(carried, w3)));
  take_axes_across(section, plane, turn_in_plane(plane.contacts, frame_s));
}

void take_axes(CrossSection& section, const std::array<glm::vec3, 3>& axes) {
  const glm::mat3 covariance = covariance_of(section);
  const InPlane plane = principal_in_plane(covariance, axes[0], axes[1]);
  section.axes = axes;
  section.turn = plane.first;
  section.eigenvalues = {plane.l1, plane.l2, variance_along(covariance, axes[2])};
}

}  // namespace palpa::touch
