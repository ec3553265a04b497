#include "driver/autd3_udp/wire.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace palpa::driver::autd3_udp {
namespace {

// The table of releases. The next protocol is one more line.
constexpr Protocol table[] = {
    {.byte = 2,
     .firmware = "0.10 and 0.11",
     .minor_from = 10,
     .minor_to = 11,
     .counts_frames = true,
     .carries_time = false,
     .pairs = false,
     .has_settings = false,
     .failsafe_flag = false,
     .least_info = 20,
     .least_counters = 30},
    {.byte = 3,
     .firmware = "0.12",
     .minor_from = 12,
     .minor_to = 12,
     .counts_frames = true,
     .carries_time = true,
     .pairs = false,
     .has_settings = false,
     .failsafe_flag = false,
     .least_info = 20,
     .least_counters = 35},
    {.byte = 5,
     .firmware = "0.13",
     .minor_from = 13,
     .minor_to = 13,
     .counts_frames = false,
     .carries_time = true,
     .pairs = true,
     .has_settings = true,
     .failsafe_flag = true,
     .least_info = 6,
     .least_counters = 27},
};

constexpr std::uint8_t at_once = 0xff;
constexpr std::uint16_t for_ever = 0xffff;
constexpr std::size_t raw_size = 2 * transducers;

/// Writes one byte after the other to the end of a datagram.
class Writer {
 public:
  Writer(Datagram& to, std::uint8_t protocol, Kind kind) : to_(to) {
    to.size = 0;
    u8(protocol);
    u8(static_cast<std::uint8_t>(kind));
    u16(0);
  }
  /// A frame, up to what its command asks for.
  Writer(Datagram& to, const Protocol& protocol, Command command) : Writer(to, protocol.byte, Kind::frame) {
    u8(0);
    u8(static_cast<std::uint8_t>(command));
    if (protocol.carries_time) u32(0);
  }

  void u8(std::uint8_t value) {
    assert(to_.size < to_.bytes.size());
    to_.bytes[to_.size++] = value;
  }
  void u16(std::uint16_t value) { number(value, 2); }
  void u32(std::uint32_t value) { number(value, 4); }
  void u64(std::uint64_t value) { number(value, 8); }
  void bytes(std::span<const std::uint8_t> values) {
    for (const std::uint8_t value : values)
      u8(value);
  }

 private:
  void number(std::uint64_t value, int size) {
    for (int byte = 0; byte < size; ++byte)
      u8(static_cast<std::uint8_t>(value >> (8 * byte)));
  }

  Datagram& to_;
};

void set_u16(Datagram& to, std::size_t at, std::uint16_t value) {
  to.bytes[at] = static_cast<std::uint8_t>(value & 0xff);
  to.bytes[at + 1] = static_cast<std::uint8_t>(value >> 8);
}

std::uint64_t number(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;)
    value = value << 8 | bytes[i];
  return value;
}

/// One pattern; without emissions, of silence.
void write_raw(Writer& out, const Protocol& protocol, std::span<const Emission> pattern) {
  const auto at = [&](std::size_t t) { return pattern.empty() ? Emission{0, 0} : pattern[t]; };
  if (protocol.pairs) {
    for (std::size_t t = 0; t < transducers; ++t) {
      out.u8(at(t).phase);
      out.u8(at(t).intensity);
    }
    return;
  }
  for (std::size_t t = 0; t < transducers; ++t)
    out.u8(at(t).phase);
  for (std::size_t t = 0; t < transducers; ++t)
    out.u8(at(t).intensity);
}

void write_activation(Writer& out, std::uint8_t bank) {
  out.u8(bank);
  out.u8(at_once);
  out.u64(0);
}

}  // namespace

std::span<const Protocol> protocols() {
  return table;
}

const Protocol* find_protocol(std::uint8_t byte) {
  const auto* const found = std::ranges::find(table, byte, &Protocol::byte);
  return found == std::end(table) ? nullptr : found;
}

std::string known_protocols() {
  std::string all;
  for (const Protocol& p : table)
    all += fmt::format("{}{} (firmware {})", all.empty() ? "" : ", ", p.byte, p.firmware);
  return all;
}

std::string_view frame_status(std::uint8_t status) {
  switch (status) {
    case 0x00:
      return "done";
    case 0x01:
      return "unknown command";
    case 0x02:
      return "wrong length or value";
    case 0x04:
      return "changes faster than the silencer";
    case 0x05:
      return "wrong way to change banks";
    case 0x06:
      return "its time is too near";
    case 0x07:
      return "the FPGA does not answer";
    case 0x08:
      return "no pulse";
    case 0x12:
      return "about to reboot";
    case status_sync_missed:
      return "the clocks were not aligned";
    case 0x15:
      return "the cause of the failsafe is still there";
    default:
      return "fault";
  }
}

void put_request(Datagram& to, std::uint8_t protocol, Kind kind, std::uint16_t id) {
  Writer(to, protocol, kind);
  set_u16(to, 2, id);
}

void put_assign(Datagram& to, const Protocol& protocol, std::uint16_t id, std::uint8_t unit) {
  Writer out(to, protocol.byte, Kind::assign);
  out.u8(unit);
  out.u8(unit == 0 ? 1 : 0);  // the first unit has the time
  set_u16(to, 2, id);
}

void put_set_time(Datagram& to, const Protocol& protocol, std::uint16_t id, std::uint64_t ns) {
  Writer out(to, protocol.byte, Kind::set_time);
  out.u64(ns);
  set_u16(to, 2, id);
}

void stamp(Datagram& frame, const Protocol& protocol, const Stamp& stamp) {
  set_u16(frame, 2, stamp.id);
  frame.bytes[datagram_head] = protocol.counts_frames ? stamp.sequence : std::uint8_t{0};
  if (!protocol.carries_time) return;
  set_u16(frame, datagram_head + 2, static_cast<std::uint16_t>(stamp.exec_at & 0xffff));
  set_u16(frame, datagram_head + 4, static_cast<std::uint16_t>(stamp.exec_at >> 16));
}

std::uint32_t exec_at(double ns) {
  constexpr double whole = 4294967296.0;
  const double us = std::ceil(std::max(ns, 0.0) / 1000);
  const auto at = static_cast<std::uint32_t>(us - whole * std::floor(us / whole));
  return at == 0 ? 1 : at;
}

void put_command(Datagram& to, const Protocol& protocol, Command command) {
  Writer(to, protocol, command);
}

void put_settings(Datagram& to, const Protocol& protocol, std::uint16_t failsafe_ms) {
  // All but the failsafe as the firmware has it by default.
  Writer out(to, protocol, Command::settings);
  out.u32(250000);
  for (const std::uint16_t value : {8, 3, 6, 1000, 64})
    out.u16(value);
  for (const std::uint32_t value : {10000U, 100U, 50U, 1U, 500000U})
    out.u32(value);
  out.u16(failsafe_ms);
  for (const std::uint16_t value : {32, 5, 48, 64, 8, 0, 3, 1000})
    out.u16(value);
}

void put_pattern_at_once(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::span<const Emission> pattern) {
  Writer out(to, protocol, Command::pattern_at_once);
  write_activation(out, bank);
  write_raw(out, protocol, pattern);
}

void put_raw(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint16_t first,
             std::span<const Emission> patterns) {
  const std::size_t count = std::max<std::size_t>(patterns.size() / transducers, 1);
  Writer out(to, protocol, Command::write_raw);
  out.u8(bank);
  out.u8(static_cast<std::uint8_t>(count));
  out.u16(first);
  for (std::size_t i = 0; i < count; ++i)
    write_raw(out, protocol, patterns.empty() ? patterns : patterns.subspan(i * transducers, transducers));
}

void put_phases(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint16_t first,
                std::span<const Emission> patterns) {
  constexpr std::uint8_t bits = 8;
  Writer out(to, protocol, Command::write_phases);
  out.u8(bank);
  out.u8(bits);
  out.u8(static_cast<std::uint8_t>(patterns.size() / transducers));
  out.u8(patterns.front().intensity);
  out.u16(first);
  for (const Emission& emission : patterns)
    out.u8(emission.phase);
}

std::size_t foci_in_frame(const Protocol& protocol) {
  return (most_body - protocol.head() - 6) / 8;
}

void put_foci(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint32_t first,
              std::span<const FixedPoint> foci) {
  Writer out(to, protocol, Command::write_foci);
  out.u8(bank);
  out.u8(0);
  out.u32(4 * first);
  for (const FixedPoint& focus : foci) {
    constexpr std::uint64_t eighteen_bits = (1 << 18) - 1;
    const auto bits = [](std::int32_t value) { return static_cast<std::uint64_t>(value) & eighteen_bits; };
    out.u64(bits(focus.x) | bits(focus.y) << 18 | bits(focus.z) << 36 | std::uint64_t{focus.intensity} << 54);
  }
}

void put_configure_pattern(Datagram& to, const Protocol& protocol, std::uint8_t bank, const BankPlay& play) {
  const bool raw = play.foci_a_sample == 0;
  Writer out(to, protocol, Command::configure_pattern);
  out.u8(bank);
  out.u8(raw ? 1 : 0);
  out.u16(play.divider);
  out.u32(play.size);
  out.u8(play.foci_a_sample);
  out.u8(0);
  out.u16(raw ? std::uint16_t{0}
              : static_cast<std::uint16_t>(std::lround(autd3::sound_speed_steps * play.sound_speed_m_s)));
  out.u16(for_ever);
}

void put_activate(Datagram& to, const Protocol& protocol, Command what, std::uint8_t bank) {
  Writer out(to, protocol, what);
  write_activation(out, bank);
}

std::size_t samples_in_frame(const Protocol& protocol) {
  return most_body - protocol.head() - 6;
}

void put_modulation(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint32_t first,
                    std::span<const std::uint8_t> samples) {
  Writer out(to, protocol, Command::write_modulation);
  out.u8(bank);
  out.u8(0);
  out.u32(first);
  out.bytes(samples);
}

void put_configure_modulation(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint16_t divider,
                              std::uint32_t size) {
  Writer out(to, protocol, Command::configure_modulation);
  out.u8(bank);
  out.u8(0);
  out.u16(divider);
  out.u32(size);
  out.u16(for_ever);
}

void put_silencer(Datagram& to, const Protocol& protocol, const Silencer& silencer) {
  constexpr std::uint8_t fixed_rate = 1, strict = 2;
  constexpr std::uint16_t default_rate = 256;
  const std::uint16_t rate = silencer.fixed_rate != 0 ? silencer.fixed_rate : default_rate;
  Writer out(to, protocol, Command::silencer);
  out.u8(static_cast<std::uint8_t>((silencer.fixed_rate != 0 ? fixed_rate : 0) | (silencer.strict ? strict : 0)));
  out.u8(0);
  out.u16(rate);
  out.u16(rate);
  out.u16(silencer.amplitude_steps);
  out.u16(silencer.phase_steps);
}

void put_phase_correction(Datagram& to, const Protocol& protocol, std::span<const std::uint8_t> phases) {
  Writer out(to, protocol, Command::phase_correction);
  out.bytes(phases);
}

void put_mask(Datagram& to, const Protocol& protocol, const std::array<bool, transducers>& on) {
  Writer out(to, protocol, Command::mask);
  constexpr std::size_t words = 16, bits = 16;
  for (std::size_t word = 0; word < words; ++word) {
    unsigned value = 0;
    for (std::size_t bit = 0; bit < bits; ++bit) {
      const std::size_t t = bits * word + bit;
      if (t < transducers && on[t]) value |= 1U << bit;
    }
    out.u16(static_cast<std::uint16_t>(value));
  }
}

std::optional<Answer> parse_answer(std::span<const std::uint8_t> datagram) {
  constexpr std::size_t answer_head = 12;  // of a frame and a heartbeat
  if (datagram.size() <= datagram_head || datagram[1] > static_cast<std::uint8_t>(Kind::heartbeat)) return std::nullopt;
  Answer out;
  out.protocol = datagram[0];
  out.kind = static_cast<Kind>(datagram[1]);
  out.id = static_cast<std::uint16_t>(number(datagram.subspan(2, 2)));
  const std::span<const std::uint8_t> body = datagram.subspan(datagram_head);
  const Protocol* const protocol = find_protocol(out.protocol);
  if (out.kind == Kind::frame || out.kind == Kind::heartbeat) {
    if (body.size() < answer_head) {
      // The only short answer is one that says that it understands another protocol.
      if (body.size() != 1 || body[0] != status_wrong_protocol) return std::nullopt;
      out.status = body[0];
      return out;
    }
    out.sequence = body[0];
    out.status = body[1];
    out.flags = body[2];
    out.unit = body[3];
    out.time_ns = number(body.subspan(4, 8));
    out.data = body.subspan(answer_head);
    return out;
  }
  out.status = body[0];
  out.data = body.subspan(1);
  if (out.kind == Kind::info && out.status == status_ok) {
    if (protocol == nullptr || out.data.size() < protocol->least_info) return std::nullopt;
    out.unit = out.data[0];
    out.flags = out.data[1];
  }
  if (out.kind == Kind::open_far_port && out.status == status_ok && out.data.empty()) return std::nullopt;
  return out;
}

std::optional<Versions> parse_versions(const Answer& answer) {
  const std::span<const std::uint8_t> d = answer.data;
  if (d.size() < 6) return std::nullopt;
  return Versions{{d[0], d[1], d[2]}, {d[3], d[4], d[5]}};
}

std::optional<std::uint32_t> parse_late(const Answer& answer, const Protocol& protocol) {
  if (!protocol.carries_time || answer.data.size() < protocol.least_counters) return std::nullopt;
  return static_cast<std::uint32_t>(number(answer.data.subspan(protocol.least_counters - 4U, 4)));
}

}  // namespace palpa::driver::autd3_udp
