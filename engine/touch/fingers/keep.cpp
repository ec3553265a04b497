#include "touch/fingers/keep.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "touch/fingers/known.hpp"

namespace palpa::touch {
namespace {

shader::vec4 vec4(const glm::vec3& v, float w = 0) {
  return {v.x, v.y, v.z, w};
}

/// Skin may reach beyond the shell's edges around a finger that is about to end.
void add_reach(const SkinSamples& samples, const glm::vec3& inward, const KnownFinger& finger,
               shader::ReachTable& table) {
  if (!(glm::dot(inward, inward) > 0)) return;
  const glm::vec3 first = samples.front().position;
  glm::vec3 sum{0};
  for (const SkinSample& sample : samples)
    sum += sample.position - first;
  const glm::vec3 centre = first + sum * (1.0F / static_cast<float>(samples.size()));
  float farthest = 0;
  for (const SkinSample& sample : samples)
    farthest = std::max(farthest, square_apart(sample.position, centre));
  table.fingers[table.count++] = {.velocity = vec4(finger.velocity),
                                  .centre = vec4(centre, squared_reach(std::sqrt(farthest))),
                                  .inward = vec4(inward),
                                  .solid = finger.solid};
}

/// The insides of a finger's samples, and their box.
void keep_insides(const SkinSamples& samples, const glm::vec3& first_contact, float width, KnownFinger& kept) {
  for (const SkinSample& sample : samples)
    kept.insides.push_back(inside_of(sample, width));
  if (samples.empty()) kept.insides.push_back(first_contact);
  kept.low = kept.high = kept.insides.front();
  for (const glm::vec3& inside : kept.insides) {
    kept.low = glm::min(kept.low, inside);
    kept.high = glm::max(kept.high, inside);
  }
}

}  // namespace

void keep_fingers(const FingerSkins& skins, const FingerOptions& parameters, const Tracks& tracks,
                  const Continuations& continuations, const HysteresisRules& rules, Touch& touch, KnownFingers& table) {
  table.count = touch.finger_count;
  table.reach.count = 0;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    Finger& finger = touch.fingers[f];
    const SkinSamples& samples = skins[f].samples;
    const std::uint32_t in_shell = contacts_in_shell(touch, finger);
    KnownFinger& kept = table.fingers[f];
    kept = {
        .solid = finger.solid, .velocity = tracks.tracks[f].velocity, .insides = {}, .continuation = continuations[f]};
    kept.continuation.fall = rules.falling ? next_fall(continuations[f].fall, in_shell) : Fall{.contacts = in_shell};
    const bool falls = kept.continuation.fall.falls;
    finger.holds = rules.few && !falls;
    finger.inward = normal_of(samples);
    if (rules.edges && !falls && starves(in_shell, parameters.min_points) && !samples.empty())
      add_reach(samples, finger.inward, kept, table.reach);
    keep_insides(samples, first_place(touch, finger), static_cast<float>(parameters.finger_width_m), kept);
  }
}

void leave_out_beyond(Touch& touch, std::vector<std::uint32_t>& scratch) {
  const auto is_beyond = [](const Contact& contact) { return contact.beyond != 0; };
  if (std::ranges::none_of(touch.contacts, is_beyond)) return;
  scratch.clear();  // where each contact will be
  std::uint32_t kept = 0;
  for (const Contact& contact : touch.contacts)
    scratch.push_back(is_beyond(contact) ? kept : kept++);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    Finger& finger = touch.fingers[f];
    std::erase_if(finger.contacts, [&](std::uint32_t i) { return is_beyond(touch.contacts[i]); });
    for (std::uint32_t& i : finger.contacts)
      i = scratch[i];
    finger.contact_count = static_cast<std::uint32_t>(finger.contacts.size());
  }
  std::erase_if(touch.contacts, is_beyond);
}

}  // namespace palpa::touch
