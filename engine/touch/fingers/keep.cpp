#include "touch/fingers/keep.hpp"

#include <algorithm>
#include <cstddef>

#include "shaders/touch/contacts/known_math.h"
#include "touch/fingers/split_math.hpp"

namespace palpa::touch {
namespace {

/// Where skin may reach beyond the shell's edges, for a finger that is about to end.
void set_reach(const SkinSamples& samples, shader::KnownFinger& finger) {
  const Float3 first = samples.front().position;
  Float3 place{0, 0, 0}, normal{0, 0, 0};
  for (const SkinSample& sample : samples) {
    place = plus(place, minus(sample.position, first));
    normal = plus(normal, sample.normal);
  }
  const Float3 centre = plus(first, scaled(place, 1.0F / static_cast<float>(samples.size())));
  float farthest = 0;
  for (const SkinSample& sample : samples)
    farthest = std::max(farthest, square_apart(sample.position, centre));
  if (!(dot3(normal, normal) > 0)) return;
  const Float3 inward = unit(normal);
  finger.centre = {centre.x, centre.y, centre.z, shader::squared_reach(root_of(farthest, 1.0F))};
  finger.inward = {inward.x, inward.y, inward.z, 0};
}

}  // namespace

void keep_fingers(const Sight& sight, const Parameters& parameters, const Tracks& tracks, const ClaimList& claims,
                  std::uint32_t rules, Touch& touch, shader::KnownTable& table) {
  const auto width = static_cast<float>(parameters.finger_width_m);
  table.count = touch.finger_count;
  table.reaching = 0;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    Finger& finger = touch.fingers[f];
    const SkinSamples samples = sample_skin(sight, touch, finger);
    const auto in_shell = static_cast<std::uint32_t>(
        std::ranges::count_if(finger.contacts, [&](std::uint32_t i) { return touch.contacts[i].beyond == 0; }));
    shader::KnownFinger& kept = table.fingers[f];
    kept = {finger.solid,
            std::max(static_cast<std::uint32_t>(samples.size()), 1U),
            0,
            claims[f].parting_us,
            tracks.tracks[f].velocity,
            claims[f].meeting_us,
            (rules & shader::known_falling) != 0 ? next_fall(claims[f].fall, in_shell) : shader::Fall{in_shell, 0, 0},
            {},
            {}};
    const bool falls = kept.fall.falls != 0;
    finger.holds = (rules & shader::known_few) != 0 && !falls;
    if ((rules & shader::known_edges) != 0 && !falls && shader::starves(in_shell, parameters.min_points) &&
        !samples.empty())
      set_reach(samples, kept);
    table.reaching += kept.centre.w > 0 ? 1 : 0;
    if (samples.empty()) {  // its place instead
      const glm::vec3& first = touch.contacts[finger.contacts.front()].position;
      table.insides[std::size_t{f} * shader::known_samples] = {first.x, first.y, first.z, 0};
    }
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Float3 inside = inside_of(samples[s].position, samples[s].normal, width);
      table.insides[std::size_t{f} * shader::known_samples + s] = {inside.x, inside.y, inside.z, 0};
    }
  }
}

void leave_out_beyond(Touch& touch, std::vector<std::uint32_t>& place) {
  constexpr std::uint32_t none = shader::known_none;
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
