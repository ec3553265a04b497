#include "driver/autd3/pattern.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "array/layouts/board_types.hpp"
#include "base/error.hpp"

namespace palpa::driver::autd3 {

Pattern::Pattern(std::size_t count, std::size_t most_parts)
    : transducers_(count), emissions_(count * most_parts), foci_(most_parts) {}

void Pattern::encode(const BoardPlan& plan) {
  const session::Cycle& cycle = plan.slots.cycle;
  parts_ = std::min<std::uint32_t>(cycle.length, static_cast<std::uint32_t>(foci_.size()));
  full_ = even_ = true;
  for (std::size_t t = 0; t < parts_ * transducers_; ++t) {
    emissions_[t] = emission(plan.drives[t]);
    full_ = full_ && emissions_[t].intensity == 255;
    even_ = even_ && emissions_[t].intensity == emissions_[t - t % transducers_].intensity;
  }
  foci_count_ = plan.foci.size() == parts_ ? parts_ : 0;
  std::copy_n(plan.foci.begin(), foci_count_, foci_.begin());
  until_slot_ = plan.slots.until;
  modulation_hz_ = cycle.modulation_hz;
  modulation_ = cycle.modulation;
  slot_s_ = plan.slot_s;
  begin_s_ = plan.from_s - static_cast<double>(plan.slots.from) * plan.slot_s;
}

FixedPoint fixed_point(const Vec3& focus, const array::Layout& layout, std::size_t device) {
  const array::Board& board = layout.boards[device];
  const Vec3 way = focus - layout.transducers[board.first].position;
  const auto along = [&](int axis) {
    const double units = glm::dot(way, Vec3(board.T_layout_board[axis])) / fixed_unit_m;
    return static_cast<std::int32_t>(std::lround(std::clamp(units, -1e9, 1e9)));
  };
  return {along(0), along(1), along(2)};
}

bool can_be_foci(const Pattern& pattern, const array::Layout& layout, double sound_speed_m_s) {
  const std::span<const Vec3> foci = pattern.foci();
  if (!pattern.even() || foci.size() < 2) return false;
  if (sound_speed_m_s > most_sound_speed_m_s || layout.frequency_hz != period_hz) return false;
  // Devices get the speed in steps, which matter if it is low and the way long.
  constexpr double most_turns_off = 2.0 / 256;
  const double told_m_s = std::round(sound_speed_m_s * sound_speed_steps) / sound_speed_steps;
  const double off_turns_per_m = std::abs(1 / told_m_s - 1 / sound_speed_m_s) * period_hz;
  return std::ranges::all_of(foci, [&](const Vec3& focus) {
    for (std::size_t d = 0; d < layout.boards.size(); ++d) {
      const double way = glm::length(focus - layout.transducers[layout.boards[d].first].position);
      if (!within_reach(fixed_point(focus, layout, d)) || way * off_turns_per_m > most_turns_off) return false;
    }
    return true;
  });
}

std::uint16_t divider_of(double slot_s, std::string_view link) {
  const double periods = slot_s * period_hz;
  if (!(std::abs(periods - std::round(periods)) < 1e-6 && periods > 0.5 && periods <= 65535)) {
    throw bad_usage(
        fmt::format("link {}: a slot of {:g} ms is not a whole number of periods of 0.025 ms; choose a --dwell that "
                    "is, such as {:g}ms",
                    link, 1e3 * slot_s, std::max(1.0, std::round(periods)) * 0.025));
  }
  return static_cast<std::uint16_t>(std::lround(periods));
}

void PartOffset::follow(double begin_s, double slot_s, double day_s) {
  const double ahead = (begin_s + day_s - epoch_s) / slot_s;  // start of slot 0, in the devices' count
  if (known_ && std::abs(ahead - static_cast<double>(ahead_)) <= 1) return;
  ahead_ = std::llround(ahead);
  known_ = true;
}

std::uint32_t PartOffset::part_at(std::uint32_t index, std::uint32_t parts) const {
  const std::int64_t part = (static_cast<std::int64_t>(index) - ahead_) % parts;
  return static_cast<std::uint32_t>(part < 0 ? part + parts : part);
}

ModulationSamples modulation_samples(double hz, array::Modulation modulation, double begin_s, double day_s,
                                     double now_s) {
  ModulationSamples out;
  out.count = 2;
  if (hz == 0) {
    out.samples.fill(255);
    return out;
  }
  static const array::BoardType& type = *array::find_board_type("autd3");
  out.divider = static_cast<std::uint16_t>(std::lround(type.modulation_slot_s(hz) * period_hz));
  const double rate_hz = period_hz / out.divider;
  double least = 1;
  for (std::size_t count = 2; count <= out.samples.size(); ++count) {
    const double cycles = static_cast<double>(count) * hz / rate_hz;
    const double miss = std::abs(cycles - std::round(cycles)) / std::max(cycles, 1.0);
    if (std::round(cycles) < 1 || miss > least - 1e-9) continue;
    least = miss;
    out.count = count;
  }
  const double whole_s = static_cast<double>(out.count) / rate_hz;
  const double played_hz = std::max(1.0, std::round(whole_s * hz)) / whole_s;
  const double first_s = std::floor((now_s + day_s - epoch_s) / whole_s) * whole_s;  // on the devices' clock
  for (std::size_t i = 0; i < out.count; ++i) {
    const double at_s = first_s + (static_cast<double>(i) + 0.5) / rate_hz - (begin_s + day_s - epoch_s);
    const double gain = array::modulation_gain(modulation, played_hz, at_s);
    out.samples[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(gain, 0.0, 1.0)));
  }
  return out;
}

}  // namespace palpa::driver::autd3
