#include "driver/autd3/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "array/layouts/board_types.hpp"

namespace palpa::driver::autd3 {
namespace {

enum Tag : std::uint8_t {
  nop = 0x00,
  clear = 0x01,
  sync = 0x02,
  version = 0x03,
  modulation = 0x10,
  silencer = 0x21,
  gain = 0x30,
  gain_pattern = 0x41,
  foci_pattern = 0x42,
  change_gain_pattern = 0x43,
  change_foci_pattern = 0x44,
};
constexpr std::uint8_t begin_flag = 1, end_flag = 2, transition_flag = 4, segment_flag = 8;
constexpr std::uint8_t no_transition = 0xfe, at_once = 0xff;
constexpr std::uint16_t for_ever = 0xffff;
enum Mode : std::uint8_t { phases_and_intensities = 0, phases = 1 };

/// Writes one byte after the other from the beginning of a payload.
class Writer {
 public:
  explicit Writer(Message message) : message_(message) { std::fill(message.begin(), message.end(), std::uint8_t{0}); }
  void u8(std::uint8_t value) { message_[at_++] = value; }
  void u16(std::uint16_t value) {
    u8(static_cast<std::uint8_t>(value & 0xff));
    u8(static_cast<std::uint8_t>(value >> 8));
  }
  void zeros(std::size_t count) { at_ += count; }
  /// Begins a second operation.
  void second() {
    const std::size_t offset = at_ - header_size;
    message_[2] = static_cast<std::uint8_t>(offset & 0xff);
    message_[3] = static_cast<std::uint8_t>(offset >> 8);
  }

 private:
  Message message_;
  std::size_t at_ = header_size;
};

void put_pattern_head(Writer& out, const PatternStep& step, Mode mode, std::size_t parts) {
  std::uint8_t flags = static_cast<std::uint8_t>((parts - 1) << 6);
  if (step.first) flags |= begin_flag;
  if (step.last) flags |= end_flag;
  if (step.segment != 0) flags |= segment_flag;
  out.u8(gain_pattern);
  out.u8(flags);
  if (!step.first) return;
  out.u8(mode);
  out.u8(no_transition);
  out.u16(step.divider);
  out.u16(for_ever);
  out.zeros(8);  // the time of a transition
}

void put_transition(Writer& out, Tag change, std::uint8_t segment) {
  out.second();
  out.u8(change);
  out.u8(segment);
  out.u8(at_once);
  out.zeros(13);
}

const array::AmplitudeSteps& amplitudes = *array::find_board_type("autd3")->amplitudes();

}  // namespace

Emission emission(array::TransducerDrive drive) {
  const double turns = drive.phase / (2 * std::numbers::pi);
  const int phase = static_cast<int>(std::floor(256 * (turns - std::floor(turns)) + 0.5)) % 256;
  return {static_cast<std::uint8_t>(phase), amplitudes.code(amplitudes.below(drive.amplitude))};
}

void put_nop(Message message) {
  Writer(message).u8(nop);
}

void put_clear_and_sync(Message message) {
  Writer out(message);
  out.u16(clear);
  out.second();
  out.u16(sync);
}

void put_version(Message message, Version which) {
  Writer out(message);
  out.u8(version);
  out.u8(static_cast<std::uint8_t>(which));
}

void put_silencer(Message message, std::uint16_t intensity_steps, std::uint16_t phase_steps) {
  constexpr std::uint8_t strict = 4;
  Writer out(message);
  out.u8(silencer);
  out.u8(strict);
  out.u16(intensity_steps);
  out.u16(phase_steps);
}

void put_gain(Message message, std::uint8_t segment, std::span<const Emission> emissions) {
  constexpr std::uint8_t update = 1;
  Writer out(message);
  out.u8(gain);
  out.u8(segment);
  out.u16(update);
  for (const Emission& e : emissions) {
    out.u8(e.phase);
    out.u8(e.intensity);
  }
}

void put_silence(Message message, std::uint8_t segment) {
  put_gain(message, segment, {});
}

void put_modulation(Message message, std::uint8_t segment, std::uint16_t divider,
                    std::span<const std::uint8_t> samples) {
  Writer out(message);
  out.u8(modulation);
  out.u8(static_cast<std::uint8_t>(begin_flag | end_flag | transition_flag | (segment != 0 ? segment_flag : 0)));
  out.u8(static_cast<std::uint8_t>(samples.size()));
  out.u8(at_once);
  out.u16(divider);
  out.u16(for_ever);
  out.zeros(8);
  for (const std::uint8_t sample : samples)
    out.u8(sample);
}

void put_pattern(Message message, const PatternStep& step, std::span<const Emission> part) {
  Writer out(message);
  put_pattern_head(out, step, phases_and_intensities, 1);
  for (const Emission& e : part) {
    out.u8(e.phase);
    out.u8(e.intensity);
  }
  if (step.last) put_transition(out, change_gain_pattern, step.segment);
}

void put_pattern_phases(Message message, const PatternStep& step, std::span<const Emission> part,
                        std::span<const Emission> next) {
  Writer out(message);
  put_pattern_head(out, step, phases, next.empty() ? 1 : 2);
  for (std::size_t i = 0; i < part.size(); ++i) {
    out.u8(part[i].phase);
    out.u8(next.empty() ? 0 : next[i].phase);
  }
  if (step.last) put_transition(out, change_gain_pattern, step.segment);
}

bool within_reach(const FixedPoint& focus) {
  constexpr std::int32_t most = (1 << 17) - 1, widest = 6909, highest = 5283;  // extent of a device's transducers
  const auto near = [](std::int32_t value, std::int32_t extent) { return value >= extent - most && value <= most; };
  if (!near(focus.x, widest) || !near(focus.y, highest) || !near(focus.z, 0)) return false;
  const auto square = [](std::int64_t value) { return value * value; };
  const std::int64_t far = square(std::max(std::abs(focus.x), std::abs(focus.x - widest))) +
                           square(std::max(std::abs(focus.y), std::abs(focus.y - highest))) + square(focus.z);
  return far <= std::numeric_limits<std::int32_t>::max();
}

void put_foci(Message message, std::uint8_t segment, std::uint16_t divider, double sound_speed_m_s,
              std::span<const FixedPoint> foci) {
  constexpr std::uint64_t eighteen_bits = (1 << 18) - 1;
  Writer out(message);
  out.u8(foci_pattern);
  out.u8(begin_flag | end_flag);
  out.u8(static_cast<std::uint8_t>(foci.size()));
  out.u8(segment);
  out.u8(no_transition);
  out.u8(1);  // focus per part
  out.u16(static_cast<std::uint16_t>(std::lround(sound_speed_steps * sound_speed_m_s)));
  out.u16(divider);
  out.u16(for_ever);
  out.zeros(4 + 8);
  for (const FixedPoint& focus : foci) {
    const auto bits = [](std::int32_t value) { return static_cast<std::uint64_t>(value) & eighteen_bits; };
    const std::uint64_t word =
        bits(focus.x) | bits(focus.y) << 18 | bits(focus.z) << 36 | std::uint64_t{focus.intensity} << 54;
    for (int byte = 0; byte < 8; ++byte)
      out.u8(static_cast<std::uint8_t>(word >> (8 * byte)));
  }
  put_transition(out, change_foci_pattern, segment);
}

void set_id(Message message, std::uint8_t id) {
  message[0] = id;
}

}  // namespace palpa::driver::autd3
