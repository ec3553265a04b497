#include "acoustics/audible.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double beta = 1.2, mean_square_directivity = 0.291;
constexpr double hearing_pa = 20e-6;  ///< of 0 dB

/// One transducer from slot to slot: what its drive goes through, and what comes out of the resonator.
struct Resonator {
  Complex out = 0;
  double amplitude = 0, phase = 0;  ///< of the last drive

  /// Plays a slot of `periods` to another drive and adds the squares of its output to `power`, one for each period.
  /// `rest`: what is left of the difference to the drive after a period.
  void play(array::TransducerDrive to, const array::Changes& changes, bool jumps, double rest,
            std::span<double> power) {
    const double begin = amplitude, end = to.amplitude;
    const double from = begin == 0 ? to.phase : phase;
    const double way = begin == 0 || end == 0 ? 0 : std::remainder(to.phase - from, 2 * pi);
    const std::uint32_t phase_steps = jumps ? 1 : changes.phase_steps;
    const std::uint32_t amplitude_steps = jumps ? 1 : changes.amplitude_steps;
    Complex direction = std::polar(1.0, from), drive;
    const Complex turn = std::polar(1.0, way / phase_steps);
    std::size_t period = 0;
    const auto play_until = [&](std::size_t stop) {
      for (; period < stop; ++period) {
        out = drive + (out - drive) * rest;
        power[period] += std::norm(out);
      }
    };
    const std::size_t steps = std::max(phase_steps, amplitude_steps);
    for (std::size_t step = 1; step <= steps && period < power.size(); ++step) {
      if (step <= phase_steps) direction *= turn;
      drive = direction * std::lerp(begin, end, std::min(1.0, static_cast<double>(step) / amplitude_steps));
      play_until(std::min(period + changes.step_periods, power.size()));
    }
    play_until(power.size());  // after the last step, the drive stays
    amplitude = end;
    phase = from + way;
  }
};

/// The period in which each slot begins, and behind the last one the number of all.
std::vector<std::size_t> begins_of(const PlayedDrives& played, double hz) {
  const std::size_t slots = played.drives.size() / played.transducers;
  std::vector<std::size_t> begins(slots + 1);
  const double slot_s = std::min(played.slot_s, longest_change_s);
  for (std::size_t s = 0; s <= slots; ++s)
    begins[s] = static_cast<std::size_t>(std::llround(static_cast<double>(s) * slot_s * hz));
  return begins;
}

}  // namespace

std::vector<double> radiated_power(const PlayedDrives& played, double q, const EarOptions& options) {
  const double hz = options.air.medium.frequency, c = options.air.medium.sound_speed;
  const std::vector<std::size_t> begins = begins_of(played, hz);
  const std::size_t slots = begins.size() - 1;
  const double rest = std::exp(-pi / q);  // after a period
  std::vector<char> silent(slots);
  for (std::size_t s = 0; s < slots; ++s) {
    silent[s] = std::ranges::all_of(played.drives.subspan(s * played.transducers, played.transducers),
                                    [](const array::TransducerDrive& one) { return one.amplitude == 0; });
  }
  std::vector<double> power(begins.back()), before(begins.back());
  // Until the sound is as it repeats. Short cycles take many rounds, because a resonator follows within q / pi periods.
  const auto rounds = static_cast<std::size_t>(std::ceil(20 * q / pi / static_cast<double>(power.size())));
  for (std::size_t t = 0; t < played.transducers; ++t) {
    Resonator resonator;
    for (std::size_t round = 0; round <= rounds; ++round) {
      for (std::size_t s = 0; s < slots; ++s) {
        const bool jumps = silent[s] != 0 && played.changes.silence_jumps;
        resonator.play(played.drives[s * played.transducers + t], played.changes, jumps, rest,
                       std::span(round < rounds ? before : power).subspan(begins[s], begins[s + 1] - begins[s]));
      }
    }
  }
  const double of_one = options.source_level_pa_m * options.source_level_pa_m * pi * mean_square_directivity /
                        (options.air.density_kg_m3 * c);
  for (double& one : power)
    one *= of_one;
  return power;
}

HeardSound heard_sound(const PlayedDrives& played, double q, const EarOptions& options) {
  const std::vector<double> power = radiated_power(played, q, options);
  const double hz = options.air.medium.frequency, c = options.air.medium.sound_speed;
  const std::size_t count = power.size();
  HeardSound sound{.period_s = static_cast<double>(count) / hz,
                   .lines = {},
                   .slots = played.drives.size() / played.transducers,
                   .pause_s = std::max(played.slot_s - longest_change_s, 0.0)};
  sound.lines.resize(count / 2);
  const double pascals_s_w = beta / (2 * pi * c * c * options.distance_m);
  for (std::size_t n = 1; n <= sound.lines.size(); ++n) {
    const Complex turn = std::polar(1.0, 2 * pi * static_cast<double>(n) / static_cast<double>(count));
    Complex sum = 0;
    for (std::size_t k = count; k-- > 0;)  // Horner's rule
      sum = sum * turn + power[k];
    const double w = 2 * pi * static_cast<double>(n) / sound.period_s;
    sound.lines[n - 1] = Complex(0, -w) * pascals_s_w * sum / static_cast<double>(count);
    if (2 * n == count) sound.lines[n - 1] /= 2.0;  // it is its own mirror image
  }
  return sound;
}

double a_weighting_db(double hz) {
  const double f2 = hz * hz;
  const auto pole = [&](double at) { return f2 + at * at; };
  const double gain = 12194.217 * 12194.217 * f2 * f2 /
                      (pole(20.598997) * std::sqrt(pole(107.65265) * pole(737.86223)) * pole(12194.217));
  return 20 * std::log10(gain) + 2.0;
}

double a_weighted_db(const HeardSound& sound) {
  double mean_square = 0;
  for (std::size_t n = 1; n <= sound.lines.size(); ++n) {
    const double weight_db = a_weighting_db(static_cast<double>(n) / sound.period_s);
    mean_square += 2 * std::norm(sound.lines[n - 1]) * std::pow(10.0, weight_db / 10);
  }
  mean_square *= sound.period_s / (sound.period_s + static_cast<double>(sound.slots) * sound.pause_s);
  const double db = 10 * std::log10(mean_square / (hearing_pa * hearing_pa));
  constexpr double nothing_db = -150;  // a constant power has only rounding errors
  return db > nothing_db ? db : -std::numeric_limits<double>::infinity();
}

EarLevel ear_level(const PlayedDrives& played, const EarOptions& options) {
  const double one = a_weighted_db(heard_sound(played, least_q, options));
  const double other = a_weighted_db(heard_sound(played, most_q, options));
  return {std::min(one, other), std::max(one, other)};
}

void write_level(const EarLevel& level, JsonWriter& json) {
  json.key("audible_dba").begin_array();
  for (const double one : {level.low_dba, level.high_dba}) {
    if (std::isfinite(one)) {
      json.rounded(one, 2);
    } else {
      json.null();
    }
  }
  json.end_array();
}

std::string to_text(const EarLevel& level) {
  if (level.high_dba < 0.5) return "less than 0 dB(A)";
  const double low = std::max(level.low_dba, 0.0);
  if (std::round(low) == std::round(level.high_dba)) return fmt::format("{:.0f} dB(A)", level.high_dba);
  return fmt::format("{:.0f} to {:.0f} dB(A)", low, level.high_dba);
}

std::string to_wav(const HeardSound& sound, double full_scale_db, double& peak) {
  constexpr std::uint32_t rate_hz = 48000;
  constexpr double highest_hz = 16000, seconds = 3;
  const double full_scale_pa = std::numbers::sqrt2 * hearing_pa * std::pow(10.0, full_scale_db / 20);
  // The number of samples that repeat. A period is a whole number of 1/40000 s if the carrier has 40 kHz.
  constexpr int most_periods = 5;
  double repeats = sound.period_s * rate_hz;
  for (int periods = 1; periods <= most_periods; ++periods) {
    const double samples = periods * sound.period_s * rate_hz;
    if (std::abs(samples - std::round(samples)) > 1e-6) continue;
    repeats = samples;
    break;
  }
  std::vector<double> values(static_cast<std::size_t>(std::llround(std::max(repeats, 1.0))));
  for (std::size_t n = 1; n <= sound.lines.size(); ++n) {
    const double hz = static_cast<double>(n) / sound.period_s;
    if (hz > highest_hz) break;
    const Complex turn = std::polar(1.0, -2 * pi * hz / rate_hz);
    Complex now = 2.0 * sound.lines[n - 1] / full_scale_pa;
    for (double& value : values) {
      value += now.real();
      now *= turn;
    }
  }
  peak = 0;
  for (const double value : values)
    peak = std::max(peak, std::abs(value));
  const double part = static_cast<double>(values.size()) / static_cast<double>(sound.slots);
  const auto pause = static_cast<std::size_t>(std::llround(sound.pause_s * rate_hz));
  for (std::size_t s = sound.slots; pause > 0 && s > 0; --s)  // from the last one, so that places stay valid
    values.insert(values.begin() + std::llround(part * static_cast<double>(s)), pause, 0.0);
  const auto count = static_cast<std::uint32_t>(seconds * rate_hz);
  std::string wav;
  const auto number = [&](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
      wav += static_cast<char>(value >> (8 * i) & 0xff);
  };
  constexpr std::uint32_t sample_bytes = 2;
  wav += "RIFF";
  number(36 + count * sample_bytes, 4);
  wav += "WAVEfmt ";
  number(16, 4);
  number(1, 2);  // PCM
  number(1, 2);  // mono
  number(rate_hz, 4);
  number(rate_hz * sample_bytes, 4);
  number(sample_bytes, 2);
  number(8 * sample_bytes, 2);
  wav += "data";
  number(count * sample_bytes, 4);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double value = std::clamp(values[i % values.size()], -1.0, 1.0);
    number(static_cast<std::uint32_t>(std::lround(32767 * value)) & 0xffff, sample_bytes);
  }
  return wav;
}

}  // namespace palpa::acoustics
