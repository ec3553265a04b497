#include "touch/fingers/glide.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/frame_clock.hpp"
#include "touch/fingers/glide_math.hpp"
#include "touch/fingers/nearest_filled.hpp"

namespace palpa::touch {
namespace {

Float3 float3(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
Float3 float3(const shader::vec4& v) {
  return {v.x, v.y, v.z};
}
shader::vec4 vec4(const glm::vec3& v) {
  return {v.x, v.y, v.z, 0};
}

PrincipalAxes frame_of(const Float3& w1, const Float3& w3) {
  return {w1, cross3(w3, w1), w3, 0, 0, 0};
}

void glide_finger(const Track& track, Home& home, Finger& finger) {
  const auto count = static_cast<std::uint32_t>(finger.foci.size());
  const bool restart = track.since_us == follow_restart || home.foci != count;
  const float frame_s = shader::seconds_of(track.since_us);
  const Float3 centre = float3(finger.section.centroid), old_centre = float3(home.centre);
  const PrincipalAxes axes = frame_of(float3(finger.section.axes[0]), float3(finger.section.axes[2]));
  const PrincipalAxes old_axes = frame_of(float3(home.axis1), float3(home.axis3));
  const Float3 motion = motion_of(old_centre, centre, float3(home.velocity), frame_s);

  std::array<Focus, max_foci> copy;
  const std::span<const Focus> sectors = std::span(copy).first(count);
  std::copy(finger.foci.begin(), finger.foci.end(), copy.begin());
  for (std::uint32_t n = 0; n < count; ++n) {
    GlidingFocus& focus = home.focus[n];
    const bool empty = sectors[n].points == 0;
    const std::uint32_t near = nearest_filled(n, count, [&](std::uint32_t i) { return sectors[i].points != 0; });
    Float3 target = float3(sectors[near < count ? near : n].position);
    Gliding now{target, {0, 0, 0}};
    if (restart) {
      focus.empty_us = empty ? hold_us + 1 : 0;
    } else {
      const Float3 offset = minus({focus.x, focus.y, focus.z}, old_centre);
      const Float3 carried = moved(moved(old_centre, motion, 1), turned_along(offset, old_axes, axes), 1);
      focus.empty_us = empty ? us_after(focus.empty_us, track.since_us) : 0;
      if (empty && focus.empty_us <= hold_us) target = carried;
      now = glide(carried, {focus.speed_x, focus.speed_y, focus.speed_z}, target, frame_s);
    }
    focus = {now.place.x, now.place.y, now.place.z, focus.empty_us, now.speed.x, now.speed.y, now.speed.z};
    finger.foci[n].position = {now.place.x, now.place.y, now.place.z};
    finger.foci[n].held = empty && focus.empty_us <= hold_us;
  }
  finger.placed = true;
  home.centre = vec4(finger.section.centroid);
  home.velocity = track.velocity;
  home.axis1 = vec4(finger.section.axes[0]);
  home.axis3 = vec4(finger.section.axes[2]);
  home.foci = count;
}

}  // namespace

void glide_foci(const Tracks& tracks, Homes& homes, Touch& touch) {
  for (std::uint32_t f = 0; f < touch.finger_count; ++f)
    glide_finger(tracks.tracks[f], homes.homes[tracks.tracks[f].home], touch.fingers[f]);
}

}  // namespace palpa::touch
