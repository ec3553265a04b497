#include "touch/known/keep_twin.hpp"

#include "shaders/touch/split/split_math.h"

namespace palpa::touch {

void keep_fingers(const Sight& sight, const Parameters& parameters, const Tracks& tracks, const ClaimList& claims,
                  const Touch& touch, shader::KnownTable& table) {
  const auto width = static_cast<float>(parameters.finger_width_m);
  table.count = touch.finger_count;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const std::vector<SkinSample> samples = sample_skin(sight, touch, touch.fingers[f]);
    table.fingers[f] = {touch.fingers[f].solid,
                        touch.fingers[f].contact_count,
                        static_cast<std::uint32_t>(samples.size()),
                        claims[f].parting_us,
                        tracks.tracks[f].velocity,
                        claims[f].meeting_us,
                        0,
                        0,
                        0};
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const shader::Float3 inside = shader::inside_of(samples[s].position, samples[s].normal, width);
      table.insides[std::size_t{f} * shader::known_samples + s] = {inside.x, inside.y, inside.z, 0};
    }
  }
}

}  // namespace palpa::touch
