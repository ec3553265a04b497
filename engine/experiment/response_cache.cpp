#include "experiment/response_cache.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

namespace palpa::experiment {
namespace {

constexpr const char* touches_kind = "touches";
/// To be raised when the computation changes.
constexpr std::uint32_t touches_version = 3;

}  // namespace

CacheKey key_of(const ResponseSource& source, const ObservedMethod& observed) {
  CacheHash hash;
  hash.add(touches_version);
  hash.add(source.finger.mesh().positions);
  hash.add(source.finger.mesh().triangles);
  hash.add(source.finger.air().wave_number());
  for (const geometry::Solid& solid : source.solids) {
    hash.add(solid.mesh.positions);
    hash.add(solid.mesh.triangles);
  }
  hash.add(source.depths_m);
  for (const observer::FingerPlace& place : source.places) {
    hash.add(place.x_m);
    hash.add(place.z_m);
    hash.add(place.yaw_rad);
  }
  hash.add(source.factors);
  hash.add(observer::observed_samples);
  hash.add(observer::settling_samples);
  const study::PlanMethod& m = observed.method;
  hash.add(static_cast<std::uint32_t>(m.method));
  hash.add(m.foci);
  hash.add(m.stride.value_or(0));
  hash.add(m.dwell_s);
  hash.add(m.modulation_hz);
  hash.add(m.delta_m);
  hash.add(static_cast<std::uint32_t>(m.amplitude.value_or(observed.layout->amplitude_law)));
  hash.add(m.solver ? static_cast<std::uint32_t>(*m.solver) + 1 : 0U);
  hash.add(m.constraint ? static_cast<std::uint32_t>(*m.constraint) + 1 : 0U);
  for (const array::Transducer& transducer : observed.layout->transducers) {
    hash.add(transducer.position);
    hash.add(transducer.axis);
  }
  hash.add(observed.layout->source_level_pa_m);
  hash.add(observed.layout->transducer_radius_m);
  return hash.key();
}

void store_responses(const CacheKey& key, const ShapeResponses& responses) {
  std::vector<std::uint8_t> sounds;
  std::vector<std::uint16_t> counts;
  std::vector<float> maps;
  for (const observer::TouchResponse& touch : responses) {
    sounds.push_back(touch.counts.empty() ? 0 : 1);
    const auto add = [&](const std::vector<float>& values) {
      for (const float value : values)
        counts.push_back(static_cast<std::uint16_t>(value));
    };
    for (const std::vector<float>& level : touch.counts)
      add(level);
    add(touch.at_once);
    for (const std::vector<float>* map : {&touch.mean_stress, &touch.flutter, &touch.vibration})
      maps.insert(maps.end(), map->begin(), map->end());
  }
  const std::span<const std::byte> sections[]{bytes_of(sounds), bytes_of(counts), bytes_of(maps)};
  store_cached(touches_kind, key, sections);
}

std::optional<ShapeResponses> load_responses(const CacheKey& key, std::size_t touches, std::size_t sites,
                                             std::size_t levels) {
  const auto file = load_cached(touches_kind, key);
  if (!file || file->sections.size() != 3) return {};
  const auto sounds = file->section_as<std::uint8_t>(0);
  auto counts = file->section_as<std::uint16_t>(1);
  auto maps = file->section_as<float>(2);
  const auto loud = static_cast<std::size_t>(std::ranges::count(sounds, 1));
  const std::size_t of_a_level = sites * observer::model_count;
  if (sounds.size() != touches || counts.size() != loud * (levels + 1) * of_a_level || maps.size() != loud * 3 * sites)
    return {};
  ShapeResponses responses(touches);
  for (std::size_t i = 0; i < touches; ++i) {
    if (sounds[i] == 0) continue;
    observer::TouchResponse& touch = responses[i];
    const auto take_counts = [&] {
      std::vector<float> values(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(of_a_level));
      counts = counts.subspan(of_a_level);
      return values;
    };
    for (std::size_t level = 0; level < levels; ++level)
      touch.counts.push_back(take_counts());
    touch.at_once = take_counts();
    for (std::vector<float>* map : {&touch.mean_stress, &touch.flutter, &touch.vibration}) {
      map->assign(maps.begin(), maps.begin() + static_cast<std::ptrdiff_t>(sites));
      maps = maps.subspan(sites);
    }
  }
  return responses;
}

std::optional<double> load_number(const CacheKey& key) {
  const auto file = load_cached(touches_kind, key);
  if (!file || file->sections.size() != 1 || file->section_as<double>(0).size() != 1) return {};
  return file->section_as<double>(0)[0];
}

void store_number(const CacheKey& key, double value) {
  const std::vector<double> values{value};
  const std::span<const std::byte> sections[]{bytes_of(values)};
  store_cached(touches_kind, key, sections);
}

}  // namespace palpa::experiment
