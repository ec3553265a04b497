#include "touch/fingers/glide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/nearest_filled.hpp"

namespace palpa::touch {
namespace {

/// A sector that empties keeps its focus for this time.
constexpr std::uint32_t hold_us = 50000U;

constexpr float motion_s = 0.005F;  // the finger's own motion is that of its centroid, within this time
constexpr float full_turn = 6.2831853F;
constexpr float cutoff_hz = 4.0F;        // of the filter at rest,
constexpr float cutoff_per_m = 500.0F;   // plus this much per m/s of a focus relative to the finger
constexpr float speed_hz = 2.0F;         // cutoff for that speed
constexpr float most_glide_mps = 0.05F;  // largest speed of a focus relative to the finger
constexpr float astray_m = 0.01F;        // with no time between frames: a focus farther than this from its target
                                         // restarts there

/// The share of a step that a low-pass filter of this cutoff takes in a frame.
float low_pass(float hz, float frame_s) {
  const float rate = full_turn * hz * frame_s;
  return rate / (1.0F + rate);
}

/// The motion of a finger whose centroid went along `way`: that of its velocity, plus most of the centroid's motion
/// beyond that. With no time between frames, it is the centroid's motion.
glm::vec3 motion_of(const glm::vec3& way, const glm::vec3& velocity, float frame_s) {
  const glm::vec3 expected = velocity * std::min(frame_s, shader::seconds_of(coasting_us));
  return expected + (way - expected) * (frame_s > 0 ? frame_s / (frame_s + motion_s) : 1);
}

/// One step of the One Euro filter (Casiez, Roussel and Vogel, CHI 2012) for a focus that the finger's motion alone
/// would have brought to its place, towards the place where its sector has it.
void glide(GlidingFocus& focus, const glm::vec3& target, float frame_s) {
  const glm::vec3 way = target - focus.place;
  if (!(frame_s > 0)) {
    if (glm::dot(way, way) > astray_m * astray_m) focus.place = target;
    return;
  }
  const float rate = 1.0F / frame_s;
  focus.speed += (way * rate - focus.speed) * low_pass(speed_hz, frame_s);
  const float cutoff = cutoff_hz + cutoff_per_m * glm::length(focus.speed);
  const float share = low_pass(cutoff, frame_s), wanted = share * glm::length(way), most = most_glide_mps * frame_s;
  focus.place += way * (wanted > most ? share * (most / wanted) : share);
}

glm::mat3 frame_of(const CrossSection& section) {
  const auto& [w1, w2, w3] = section.axes;
  return {w1, glm::cross(w3, w1), w3};
}

void glide_finger(const Track& track, GlidingFoci& home, Finger& finger) {
  const auto count = static_cast<std::uint32_t>(finger.foci.size());
  const bool restart = !track.since_us || home.foci.size() != count;
  const std::uint32_t since_us = track.since_us.value_or(0);
  const float frame_s = shader::seconds_of(since_us);
  const glm::vec3 centre = finger.section.centroid;
  const glm::mat3 axes = frame_of(finger.section);
  const glm::vec3 motion = motion_of(centre - track.joined - home.centre, home.velocity, frame_s);
  if (restart) home.foci = {count, {}};

  std::array<Focus, max_foci> copy;
  const std::span<const Focus> sectors = std::span(copy).first(count);
  std::copy(finger.foci.begin(), finger.foci.end(), copy.begin());
  for (std::uint32_t n = 0; n < count; ++n) {
    GlidingFocus& focus = home.foci[n];
    const bool empty = sectors[n].points == 0;
    const std::uint32_t near = nearest_filled(n, count, [&](std::uint32_t i) { return sectors[i].points != 0; });
    const glm::vec3 target = sectors[near < count ? near : n].position;
    if (restart) {
      focus = {target, empty ? hold_us + 1 : 0, {}};
    } else {
      const glm::vec3 offset = focus.place - home.centre;
      focus.place = home.centre + motion + axes * (offset * home.axes);  // fixed to a finger whose axes turn
      focus.empty_us = empty ? us_after(focus.empty_us, since_us) : 0;
      glide(focus, empty && focus.empty_us <= hold_us ? focus.place : target, frame_s);
    }
    finger.foci[n].position = focus.place;
    finger.foci[n].held = empty && focus.empty_us <= hold_us;
  }
  finger.placed = true;
  home.centre = centre;
  home.velocity = track.velocity;
  home.axes = axes;
}

}  // namespace

void glide_foci(const Tracks& tracks, GlideMemory& memory, Touch& touch) {
  for (std::uint32_t f = 0; f < touch.finger_count; ++f)
    glide_finger(tracks.tracks[f], memory.foci[tracks.tracks[f].home], touch.fingers[f]);
}

}  // namespace palpa::touch
