#include "driver/autd3/emulated/device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace palpa::driver::autd3 {
namespace {

// The firmware's own numbers, written down independently of the encoder's.
constexpr std::uint8_t no_error = 0, unknown_tag = 1, bad_id = 2, bad_version_type = 3, bad_pattern_mode = 4,
                       bad_segment = 5, bad_silencer = 7, bad_transition = 8;
constexpr std::uint8_t sync_index = 0x00, system_time = 0x01, gpio = 0x02, external = 0xf0, none = 0xfe,
                       immediate = 0xff;
constexpr double ultrasound_hz = 40000;

std::uint16_t u16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

/// The firmware's tables.
struct Tables {
  std::array<std::uint8_t, 256> sine{};
  std::array<std::uint8_t, 16384> angle{};  ///< 128 sines by 128 cosines
  Tables() {
    for (int i = 0; i < 256; ++i)
      sine[i] = static_cast<std::uint8_t>(std::floor(128 + 127.5 * std::sin(2 * std::numbers::pi * i / 256)));
    for (int i = 0; i < 128 * 128; ++i) {
      const double turns = -std::atan2((i >> 7) - 64, (i & 127) - 64) / (2 * std::numbers::pi);
      angle[i] = static_cast<std::uint8_t>(static_cast<int>(std::floor(256 * turns + 0.5)) & 0xff);
    }
  }
};

std::size_t place(double now_s, std::uint32_t divider, std::size_t size) {
  return static_cast<std::size_t>(std::floor(now_s * ultrasound_hz / divider)) % size;
}

}  // namespace

EmulatedDevice::EmulatedDevice(std::uint8_t firmware) : firmware_(firmware) {
  power_up();
}

void EmulatedDevice::power_up() {
  for (Segment& segment : segments_) {
    segment = {};
    segment.parts.resize(1);
    segment.parts[0].fill({0, 0});
  }
  for (Waveform& waveform : waveforms_)
    waveform = {{255, 255}, 0xffff};
  sounding_ = heard_ = 0;
  strict_ = true;
  intensity_steps_ = 10;
  phase_steps_ = 40;
}

void EmulatedDevice::receive(double now_s, std::span<const std::uint8_t> message) {
  now_s_ = now_s;
  if (message.size() != message_size)
    return violate(fmt::format("a message of the wrong size, {} bytes", message.size()));
  if (message[0] == id_) return;  // a repeated message
  id_ = message[0];
  error_ = no_error;
  if (id_ > 0x0f) {
    error_ = bad_id;
    return violate(fmt::format("a message number that is too large: {}", id_));
  }
  const std::span<const std::uint8_t> payload = message.subspan(4);
  error_ = handle(payload);
  const std::size_t second = u16(message, 2);
  if (error_ == no_error && second != 0) {
    if (second % 2 != 0 || second >= payload.size())
      return violate(fmt::format("a second operation at byte {}, which is invalid", second));
    error_ = handle(payload.subspan(second));
  }
  if (error_ != no_error) violate(fmt::format("error {} in answer to tag 0x{:02x}", error_, payload[0]));
}

std::array<std::uint8_t, 2> EmulatedDevice::answer() const {
  return {data_, static_cast<std::uint8_t>(error_ << 4 | (id_ & 0x0f))};
}

std::uint8_t EmulatedDevice::handle(std::span<const std::uint8_t> o) {
  const std::uint8_t tag = o[0];
  const bool harmless = tag <= 0x03;
  if (!harmless && !(cleared_ && synchronised_)) violate(fmt::format("tag 0x{:02x} before clear and sync", tag));
  ++operations_;
  switch (tag) {
    case 0x00:
      return no_error;
    case 0x01:
      power_up();
      cleared_ = true;
      return no_error;
    case 0x02:
      synchronised_ = true;
      return no_error;
    case 0x03:
      return tell_version(o[1]);
    case 0x10:
      return take_modulation(o);
    case 0x21:
      return take_silencer(o);
    case 0x30:
      return take_gain(o);
    case 0x41:
      return take_pattern(o);
    case 0x42:
      return take_foci(o);
    case 0x43:
      return change_pattern(o, false);
    case 0x44:
      return change_pattern(o, true);
    default:
      return unknown_tag;
  }
}

std::uint8_t EmulatedDevice::tell_version(std::uint8_t which) {
  switch (which) {
    case 1:
    case 3:
      data_ = firmware_;
      return no_error;
    case 2:
    case 4:
      data_ = 0;
      return no_error;
    case 5:
      data_ = 0x80;
      return no_error;  // this is an emulator
    case 6:
      data_ = 0;
      return no_error;
    default:
      return bad_version_type;
  }
}

bool EmulatedDevice::too_fast(std::uint32_t pattern_divider, std::uint32_t modulation_divider) const {
  return strict_ && (modulation_divider < intensity_steps_ || pattern_divider < intensity_steps_ ||
                     pattern_divider < phase_steps_);
}

bool EmulatedDevice::wrong_transition(std::uint8_t current, std::uint8_t segment, std::uint16_t repeat,
                                      std::uint8_t mode) const {
  if (mode == none) return false;
  const bool timed = mode == sync_index || mode == system_time || mode == gpio;
  if (current == segment || repeat == 0xffff) return timed;
  return mode == immediate || mode == external;
}

std::uint8_t EmulatedDevice::take_modulation(std::span<const std::uint8_t> o) {
  const std::uint8_t flags = o[1];
  const std::uint8_t segment = (flags & 8) != 0 ? 1 : 0;
  // A modulation's first message may be its only one; palpa's always is.
  if ((flags & 3) != 3) {
    violate("a modulation in several messages, which this emulator does not support");
    return unknown_tag;
  }
  const std::size_t size = o[2];
  const std::uint16_t divider = u16(o, 4);
  if (size < 2 || 16 + size > o.size()) violate(fmt::format("a modulation of the wrong size, {} samples", size));
  if (wrong_transition(heard_, segment, u16(o, 6), o[3])) return bad_transition;
  if (too_fast(segments_[sounding_].divider, divider)) return bad_silencer;
  if (segment == heard_ && waveforms_[segment].divider != 0xffff)
    violate("a modulation into the segment that is heard");
  waveforms_[segment] = {{o.begin() + 16, o.begin() + 16 + static_cast<std::ptrdiff_t>(size)}, divider};
  if ((flags & 4) != 0) heard_ = segment;
  return no_error;
}

std::uint8_t EmulatedDevice::take_silencer(std::span<const std::uint8_t> o) {
  if ((o[1] & 1) != 0) {
    strict_ = false;
    return no_error;
  }
  const auto before = std::tuple(strict_, intensity_steps_, phase_steps_);
  strict_ = (o[1] & 4) != 0;
  intensity_steps_ = u16(o, 2);
  phase_steps_ = u16(o, 4);
  if (intensity_steps_ == 0 || phase_steps_ == 0) violate("a silencer of 0 steps");
  if (intensity_steps_ > 255 || phase_steps_ > 255) violate("a silencer of more than 255 steps");
  if (!too_fast(segments_[sounding_].divider, waveforms_[heard_].divider)) return no_error;
  std::tie(strict_, intensity_steps_, phase_steps_) = before;
  return bad_silencer;
}

std::uint8_t EmulatedDevice::take_gain(std::span<const std::uint8_t> o) {
  if (o[1] > 1) return bad_segment;
  Segment& segment = segments_[o[1]];
  segment.parts.resize(1);
  segment.divider = 0xffff;
  segment.open = segment.foci = false;
  for (std::size_t t = 0; t < transducers; ++t)
    segment.parts[0][t] = {o[4 + 2 * t], o[5 + 2 * t]};
  if ((o[2] & 1) != 0) {
    transitions_ += sounding_ != o[1] ? 1 : 0;
    sounding_ = o[1];
  }
  return no_error;
}

std::uint8_t EmulatedDevice::take_pattern(std::span<const std::uint8_t> o) {
  const std::uint8_t flags = o[1];
  const std::uint8_t index = (flags & 8) != 0 ? 1 : 0;
  const std::size_t parts = static_cast<std::size_t>(flags >> 6) + 1;
  Segment& segment = segments_[index];
  std::size_t at = 2;
  if ((flags & 1) != 0) {
    const std::uint8_t transition = o[3];
    const std::uint16_t divider = u16(o, 4), repeat = u16(o, 6);
    if (wrong_transition(sounding_, index, repeat, transition)) return bad_transition;
    if (too_fast(divider, waveforms_[heard_].divider)) return bad_silencer;
    if (index == sounding_) violate("a pattern into the segment that sounds");
    if (o[2] > 2) return bad_pattern_mode;
    mode_ = o[2];
    writing_ = index;
    segment.parts.clear();
    segment.divider = divider;
    segment.open = true;
    segment.foci = false;
    at = 16;
  }
  if (!segment.open || index != writing_) {
    violate("a part of a pattern that was not begun");
    return bad_segment;
  }
  const std::size_t bits = mode_ == 1 ? 8 : 4;  // of a phase, in words of 16 bits
  if (mode_ == 0 ? parts != 1 : parts * bits > 16) violate(fmt::format("{} parts in one message", parts));
  for (std::size_t p = 0; p < parts; ++p) {
    auto& out = segment.parts.emplace_back();
    for (std::size_t t = 0; t < transducers; ++t) {
      const std::uint16_t word = u16(o, at + 2 * t);
      const unsigned shifted = word >> (bits * p);
      if (mode_ == 0) {
        out[t] = {static_cast<std::uint8_t>(word & 0xff), static_cast<std::uint8_t>(word >> 8)};
      } else if (mode_ == 1) {
        out[t] = {static_cast<std::uint8_t>(shifted & 0xff), 0xff};
      } else {
        out[t] = {static_cast<std::uint8_t>((shifted & 0xf) * 0x11), 0xff};
      }
    }
  }
  if (segment.parts.size() > 1024) violate("a pattern of more than 1024 parts");
  if ((flags & 2) != 0) {
    segment.open = false;
    if (segment.parts.size() < 2) violate("a pattern of one part");
  }
  if ((flags & 4) != 0) violate("a transition within a pattern, which this emulator does not support");
  return no_error;
}

std::array<std::uint8_t, EmulatedDevice::transducers> EmulatedDevice::phases_of_focus(std::int32_t x, std::int32_t y,
                                                                                      std::int32_t z, std::uint32_t c) {
  static const Tables tables;
  std::array<std::uint8_t, transducers> out{};
  std::size_t t = 0;
  for (int row = 0; row < 14; ++row) {
    for (int column = 0; column < 18; ++column) {
      if (row == 1 && (column == 1 || column == 2 || column == 16)) continue;  // screws and the connector
      const std::int64_t dx = x - std::lround(406.4 * column), dy = y - std::lround(406.4 * row), dz = z;
      const std::int64_t square = dx * dx + dy * dy + dz * dz;
      auto distance = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
      while (distance * distance > square)
        --distance;
      const auto q = static_cast<std::uint64_t>(distance << 14) / c;
      const std::size_t sine = tables.sine[q % 256] >> 1, cosine = tables.sine[(q + 64) % 256] >> 1;
      out[t++] = tables.angle[sine << 7 | cosine];
    }
  }
  return out;
}

std::uint8_t EmulatedDevice::take_foci(std::span<const std::uint8_t> o) {
  if ((o[1] & 7) != 3 || o[5] != 1) {
    violate("foci in several messages, several at once, or with a transition, which this emulator does not support");
    return unknown_tag;
  }
  const std::size_t count = o[2], index = o[3];
  if (index > 1) return bad_segment;
  const std::uint16_t speed = u16(o, 6), divider = u16(o, 8);
  if (wrong_transition(sounding_, o[3], u16(o, 10), o[4])) return bad_transition;
  if (too_fast(divider, waveforms_[heard_].divider)) return bad_silencer;
  if (index == sounding_) violate("foci into the segment that sounds");
  if (count < 2 || 24 + 8 * count > o.size() || speed == 0) {
    violate(fmt::format("{} foci at a sound speed of {}", count, speed));
    return bad_segment;
  }
  Segment& segment = segments_[index];
  segment = {};
  segment.divider = divider;
  segment.foci = true;
  for (std::size_t f = 0; f < count; ++f) {
    std::uint64_t word = 0;
    for (std::size_t byte = 0; byte < 8; ++byte)
      word |= std::uint64_t{o[24 + 8 * f + byte]} << (8 * byte);
    const auto coordinate = [&](int shift) {
      const auto bits = static_cast<std::int32_t>(word >> shift & 0x3ffff);
      return bits >= 0x20000 ? bits - 0x40000 : bits;
    };
    const auto phases = phases_of_focus(coordinate(0), coordinate(18), coordinate(36), speed);
    auto& out = segment.parts.emplace_back();
    for (std::size_t t = 0; t < transducers; ++t)
      out[t] = {phases[t], static_cast<std::uint8_t>(word >> 54 & 0xff)};
  }
  return no_error;
}

std::uint8_t EmulatedDevice::change_pattern(std::span<const std::uint8_t> o, bool foci) {
  const std::uint8_t index = o[1], mode = o[2];
  if (index > 1) return bad_segment;
  const Segment& segment = segments_[index];
  if (segment.foci != foci || (!foci && segment.parts.size() < 2)) return bad_segment;
  if (segment.open) violate("a transition to an incomplete pattern");
  if (wrong_transition(sounding_, index, 0xffff, mode)) return bad_transition;
  if (too_fast(segment.divider, waveforms_[heard_].divider)) return bad_silencer;
  transitions_ += sounding_ != index ? 1 : 0;
  sounding_ = index;
  return no_error;
}

std::array<EmulatedDevice::Output, EmulatedDevice::transducers> EmulatedDevice::output(double now_s) const {
  const Segment& segment = segments_[sounding_];
  const Waveform& waveform = waveforms_[heard_];
  auto out = segment.parts[place(now_s, segment.divider, segment.parts.size())];
  const unsigned gain = waveform.samples[place(now_s, waveform.divider, waveform.samples.size())];
  for (Output& one : out)
    one.intensity = static_cast<std::uint8_t>(one.intensity * gain / 255);
  return out;
}

bool EmulatedDevice::silent(double now_s) const {
  const auto all = output(now_s);
  return std::all_of(all.begin(), all.end(), [](const Output& one) { return one.intensity == 0; });
}

bool EmulatedDevice::empty() const {
  return std::all_of(segments_.begin(), segments_.end(), [](const Segment& segment) {
    return std::all_of(segment.parts.begin(), segment.parts.end(), [](const auto& part) {
      return std::all_of(part.begin(), part.end(), [](const Output& one) { return one.intensity == 0; });
    });
  });
}

}  // namespace palpa::driver::autd3
