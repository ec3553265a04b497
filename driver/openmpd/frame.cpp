#include "driver/openmpd/frame.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace palpa::driver::openmpd {
namespace {

/// Finds widths without an arc sine. Between two neighbouring entries, the width changes at most at one amplitude,
/// because the last two such amplitudes, sin(63 pi / 128) and 1, are farther apart than an entry.
struct Widths {
  static constexpr unsigned entries = 4096;
  std::array<std::uint8_t, entries + 1> below{};  ///< the width at i / entries
  std::array<double, full_width + 2> from{};      ///< the least amplitude of each width

  Widths() {
    for (unsigned width = 1; width < full_width; ++width)
      from[width] = std::sin(width * std::numbers::pi / phase_steps);
    from[full_width] = 1;
    from[full_width + 1] = 2;
    unsigned width = 0;
    for (unsigned i = 0; i <= entries; ++i) {
      while (static_cast<double>(i) / entries >= from[width + 1])
        ++width;
      below[i] = static_cast<std::uint8_t>(width);
    }
  }
};
const Widths widths;

}  // namespace

std::uint8_t width_of(float amplitude) {
  if (!(amplitude > 0)) return 0;
  if (amplitude >= 1) return full_width;
  const unsigned below = widths.below[static_cast<unsigned>(amplitude * Widths::entries)];
  return static_cast<std::uint8_t>(below + (static_cast<double>(amplitude) >= widths.from[below + 1]));
}

Encoder::Encoder(const Calibration& calibration) {
  for (std::size_t t = 0; t < transducers; ++t) {
    transducers_[t] = {pin_of(t), calibration.factors[t], 0.5 - phase_steps / 360.0 * calibration.degrees[t]};
  }
}

void Encoder::encode(std::span<const array::TransducerDrive> drive, Frame& out) const {
  assert(drive.size() == transducers);
  constexpr double steps_per_radian = phase_steps / (2 * std::numbers::pi);
  for (std::size_t t = 0; t < transducers; ++t) {
    const auto& [pin, factor, offset_steps] = transducers_[t];
    const unsigned width = width_of(drive[t].amplitude * factor);
    // The phase is within a few turns of zero and in double precision, so the mask below removes whole turns as well as
    // fract would.
    double steps = steps_per_radian * static_cast<double>(drive[t].phase);
    if (!(std::abs(steps) < 1e6)) steps = 0;  // no drive has this, but a broken loop's memory may
    const double centring = 0.5 * (full_width - width);
    const auto rounded = static_cast<int>(std::floor(steps + offset_steps + centring));
    out[pin] = static_cast<std::uint8_t>(width == 0 ? 0 : rounded & (phase_steps - 1));
    out[transducers + pin] = static_cast<std::uint8_t>(width);
  }
  out[0] |= 0x80;
}

Frame with_divider(Frame frame, std::uint8_t divider) {
  constexpr std::size_t first_bit = 26, apply = 34;
  for (unsigned bit = 0; bit < 8; ++bit) {
    if ((divider >> bit) & 1) frame[first_bit + bit] |= 0x80;
  }
  frame[apply] |= 0x80;
  return frame;
}

}  // namespace palpa::driver::openmpd
