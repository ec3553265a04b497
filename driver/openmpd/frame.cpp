#include "driver/openmpd/frame.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "array/layouts/board_types.hpp"

namespace palpa::driver::openmpd {
namespace {

const array::AmplitudeSteps& widths = *array::find_board_type("openmpd")->amplitudes();

}  // namespace

Encoder::Encoder(const Calibration& calibration, double lag_periods) {
  for (std::size_t t = 0; t < transducers; ++t) {
    transducers_[t] = {pin_of(t), 0.5 - phase_steps * (calibration.degrees[t] / 360.0 + lag_periods)};
  }
}

void Encoder::encode(std::span<const array::TransducerDrive> drive, Frame& out) const {
  assert(drive.size() == transducers);
  constexpr double steps_per_radian = phase_steps / (2 * std::numbers::pi);
  for (std::size_t t = 0; t < transducers; ++t) {
    const auto& [pin, offset_steps] = transducers_[t];
    const unsigned width = widths.code(widths.below(drive[t].amplitude));
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
