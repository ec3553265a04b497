#include "array/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/error.hpp"
#include "geometry/haptics.hpp"

namespace palpa::array {
namespace {

// A range of 1 ns to 1000 s keeps every product below within 64 bits.
std::uint64_t nanoseconds(double seconds) {
  return static_cast<std::uint64_t>(std::llround(std::clamp(seconds, 1e-9, 1e3) * 1e9));
}

std::uint64_t steps(const Voice& voice) {
  return voice.foci_per_slot == 0 ? 0 : voice.order.size() / voice.foci_per_slot;
}

}  // namespace

void fill_order(std::uint32_t count, std::uint32_t stride, std::vector<std::uint32_t>& order) {
  if (count == 0) throw bad_usage("0 foci: there must be at least one");
  if (const std::string fault = geometry::stride_fault(count, stride); !fault.empty()) throw bad_usage(fault);
  order.resize(count);
  std::uint64_t at = 0;
  for (std::uint32_t& entry : order) {
    entry = static_cast<std::uint32_t>(at);
    at = (at + stride) % count;
  }
}

std::vector<std::uint32_t> fill_order(std::uint32_t count, std::uint32_t stride) {
  std::vector<std::uint32_t> order;
  fill_order(count, stride, order);
  return order;
}

void reserve(Schedule& schedule, std::uint32_t voices, std::uint32_t foci) {
  schedule.voices.resize(voices);
  for (Voice& voice : schedule.voices) {
    voice.foci.reserve(foci);
    voice.order.reserve(foci);
  }
}

Voice& Schedule::add_voice() {
  if (voice_count == voices.size()) voices.emplace_back();
  return voices[voice_count++];
}

std::uint32_t Advance::number_of(std::uint64_t slot) const {
  if (slot < first_slot) {
    const auto back = static_cast<std::uint32_t>((first_slot - slot) % cycle);
    return back == 0 ? 0 : cycle - back;
  }
  const std::uint64_t number = slot - first_slot;
  const std::uint64_t last_cycle = listed() - cycle;
  return static_cast<std::uint32_t>(number < last_cycle ? number : last_cycle + (number - last_cycle) % cycle);
}

double Advance::time_of(std::uint64_t slot, double slot_s) const {
  return moves() ? std::min(first_s + number_of(slot) * slot_s, most_s) : 0;
}

void foci_of_slot(const Schedule& schedule, std::uint64_t slot, std::vector<SlotFocus>& out) {
  out.clear();
  const std::uint64_t slot_ns = nanoseconds(schedule.slot_s);
  const double advance_s = schedule.advance.time_of(slot, schedule.slot_s);
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const Voice& voice = schedule.voices[v];
    const std::uint64_t count = steps(voice);
    if (count == 0) continue;
    const Vec3 way = advance_s * voice.velocity;
    const std::uint64_t step = slot * slot_ns / nanoseconds(voice.dwell_s) % count;
    const double midpoint = (static_cast<double>(slot) + 0.5) * schedule.slot_s;
    const double modulation = modulation_gain(voice.modulation, voice.modulation_hz, midpoint) *
                              modulate(voice.course, slot, schedule.slot_s);
    const auto gain = static_cast<float>(voice.gain * modulation);
    const auto pressure =
        voice.reached_pa ? std::optional(voice.target_pa * std::max(modulation, least_modulation)) : std::nullopt;
    const auto most = voice.pressure_pa ? std::optional(voice.asked_pa()) : std::nullopt;
    for (std::uint32_t together = 0; together < voice.foci_per_slot; ++together) {
      const std::uint32_t focus = voice.order[step * voice.foci_per_slot + together];
      if (focus < voice.foci.size()) out.push_back({voice.foci[focus] + way, gain, pressure, v, focus, most});
    }
  }
}

double modulation_gain(Modulation modulation, double hz, double time_s) {
  if (hz == 0) return 1;
  const double turns = hz * time_s;
  const double raised = 0.5 * (1 + std::sin(2 * std::numbers::pi * (turns - std::floor(turns))));
  return modulation == Modulation::pressure_sine ? std::sqrt(raised) : raised;
}

bool shared_modulation(const Schedule& schedule) {
  for (std::uint32_t v = 1; v < schedule.voice_count; ++v) {
    const Voice &voice = schedule.voices[v], &first = schedule.voices[0];
    if (voice.modulation_hz != first.modulation_hz) return false;
    if (voice.modulation_hz != 0 && voice.modulation != first.modulation) return false;
    if (voice.course != first.course) return false;
  }
  return true;
}

bool changes(const Schedule& schedule) {
  return std::any_of(schedule.voices.begin(), schedule.voices.begin() + schedule.voice_count,
                     [](const Voice& voice) { return voice.course.changes(); });
}

std::uint64_t first_changing_slot(const Schedule& schedule) {
  std::uint64_t slot = 0;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const Course& course = schedule.voices[v].course;
    if (course.changes()) slot = std::max(slot, course.first_slot);
  }
  return slot;
}

std::uint64_t cycle_length(const Schedule& schedule, std::uint64_t most) {
  const std::uint64_t slot_ns = nanoseconds(schedule.slot_s);
  std::uint64_t cycle = 1;
  // Lengthens the cycle to a multiple of `period`, in nanoseconds (or fractions of a turn); false if that is too long.
  const auto join = [&](std::uint64_t period) {
    const std::uint64_t slots = period / std::gcd(period, slot_ns);
    if (slots > most) return false;
    // No overflow, because neither exceeds `most`, which is bounded below.
    cycle = std::lcm(cycle, slots);
    return cycle <= most;
  };
  if (most == 0 || changes(schedule)) return 0;
  most = std::min<std::uint64_t>(most, 0xffffffffU);
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const Voice& voice = schedule.voices[v];
    const std::uint64_t count = steps(voice);
    if (count == 0) continue;
    if (count > 1 && !join(count * nanoseconds(voice.dwell_s))) return 0;
    if (voice.modulation_hz != 0) {
      // A slot is millihertz x nanoseconds / 10^12 turns.
      constexpr std::uint64_t turn = 1'000'000'000'000;
      const auto millihertz = static_cast<std::uint64_t>(std::llround(std::clamp(voice.modulation_hz, 0.0, 1e6) * 1e3));
      if (!join(turn / std::gcd(turn, millihertz))) return 0;
    }
  }
  return cycle;
}

}  // namespace palpa::array
