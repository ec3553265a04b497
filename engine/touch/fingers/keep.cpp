#include "touch/fingers/keep.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "touch/fingers/known.hpp"

namespace palpa::touch {
namespace {

/// Zero if the samples do not tell.
Float3 inward_of(const SkinSamples& samples) {
  Float3 normal{0, 0, 0};
  for (const SkinSample& sample : samples)
    normal = plus(normal, sample.normal);
  return dot3(normal, normal) > 0 ? unit(normal) : Float3{0, 0, 0};
}

/// Skin may reach beyond the shell's edges around a finger that is about to end.
void add_reach(const SkinSamples& samples, const Float3& inward, const KnownFinger& finger, shader::ReachTable& table) {
  if (!(dot3(inward, inward) > 0)) return;
  const Float3 first = samples.front().position;
  Float3 place{0, 0, 0};
  for (const SkinSample& sample : samples)
    place = plus(place, minus(sample.position, first));
  const Float3 centre = plus(first, scaled(place, 1.0F / static_cast<float>(samples.size())));
  float farthest = 0;
  for (const SkinSample& sample : samples)
    farthest = std::max(farthest, square_apart(sample.position, centre));
  table.fingers[table.count++] = {.velocity = finger.velocity,
                                  .centre = {centre.x, centre.y, centre.z, squared_reach(std::sqrt(farthest))},
                                  .inward = {inward.x, inward.y, inward.z, 0},
                                  .solid = finger.solid};
}

}  // namespace

void keep_fingers(const FingerSkins& skins, const FingerOptions& parameters, const Tracks& tracks,
                  const ClaimList& claims, std::uint32_t rules, Touch& touch, KnownFingers& table) {
  const auto width = static_cast<float>(parameters.finger_width_m);
  table.count = touch.finger_count;
  table.reach.count = 0;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    Finger& finger = touch.fingers[f];
    const SkinSamples& samples = skins[f].samples;
    const std::uint32_t in_shell = contacts_in_shell(touch, finger);
    KnownFinger& kept = table.fingers[f];
    kept = {.solid = finger.solid,
            .samples = std::max(static_cast<std::uint32_t>(samples.size()), 1U),
            .parting_us = claims[f].parting_us,
            .meeting_us = claims[f].meeting_us,
            .velocity = tracks.tracks[f].velocity,
            .fall = (rules & known_falling) != 0 ? next_fall(claims[f].fall, in_shell) : Fall{.contacts = in_shell}};
    const bool falls = kept.fall.falls;
    const Float3 inward = inward_of(samples);
    finger.holds = (rules & known_few) != 0 && !falls;
    finger.inward = to_vec(inward);
    if ((rules & known_edges) != 0 && !falls && starves(in_shell, parameters.min_points) && !samples.empty())
      add_reach(samples, inward, kept, table.reach);
    if (samples.empty()) {  // its place instead
      table.insides[f][0] = float3(touch.contacts[finger.contacts.front()].position);
    }
    for (std::size_t s = 0; s < samples.size(); ++s)
      table.insides[f][s] = inside_of(samples[s], width);
    const auto insides = std::span(table.insides[f]).first(kept.samples);
    kept.low = kept.high = insides.front();
    for (const Float3& inside : insides) {
      kept.low = lowest(kept.low, inside);
      kept.high = highest(kept.high, inside);
    }
  }
}

void leave_out_beyond(Touch& touch, std::vector<std::uint32_t>& place) {
  constexpr std::uint32_t none = known_none;
  if (std::ranges::none_of(touch.contacts, [](const Contact& contact) { return contact.beyond != 0; })) return;
  place.assign(touch.contacts.size(), none);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < touch.contacts.size(); ++i) {
    if (touch.contacts[i].beyond != 0) continue;
    place[i] = kept;
    touch.contacts[kept++] = touch.contacts[i];
  }
  touch.contacts.resize(kept);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    Finger& finger = touch.fingers[f];
    for (std::uint32_t& i : finger.contacts)
      i = place[i];
    std::erase(finger.contacts, none);
    finger.contact_count = static_cast<std::uint32_t>(finger.contacts.size());
  }
}

}  // namespace palpa::touch
