#include "driver/autd3_udp/emulated/unit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace palpa::driver::autd3_udp {
namespace {

// The firmware's own numbers, written down independently of the link's.
constexpr std::uint8_t fine = 0x00, unknown_command = 0x01, bad_payload = 0x02, silencer_forbids = 0x04,
                       bad_mode = 0x05, too_near = 0x06;
constexpr std::uint8_t next_lap = 0x00, at_time = 0x01, at_once = 0xff;
constexpr std::uint16_t for_ever = 0xffff;
constexpr std::size_t raw_bytes = 2 * EmulatedUnit::transducers, words_of_raw = 256, most_raw = 1024,
                      pattern_words = most_raw * words_of_raw, modulation_bytes = 65536;
constexpr std::uint64_t period_ns = 25000;
constexpr double default_failsafe_s = 0.5;  // of 2 and 3

std::uint16_t u16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

std::uint32_t u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return u16(bytes, at) | std::uint32_t{u16(bytes, at + 2)} << 16;
}

std::uint64_t u64(std::span<const std::uint8_t> bytes, std::size_t at) {
  return u32(bytes, at) | std::uint64_t{u32(bytes, at + 4)} << 32;
}

void put(std::vector<std::uint8_t>& out, std::uint64_t value, int bytes) {
  for (int byte = 0; byte < bytes; ++byte)
    out.push_back(static_cast<std::uint8_t>(value >> (8 * byte)));
}

/// Where the firmware has its transducers, in 0.025 mm: column and row, without the three places of screws and plug.
struct Place {
  std::int64_t x, y;
};

std::array<Place, EmulatedUnit::transducers> places() {
  std::array<Place, EmulatedUnit::transducers> out{};
  std::size_t t = 0;
  for (int row = 0; row < 14; ++row) {
    for (int column = 0; column < 18; ++column) {
      if (row == 1 && (column == 1 || column == 2 || column == 16)) continue;
      out[t++] = {std::lround(406.4 * column), std::lround(406.4 * row)};
    }
  }
  return out;
}

std::array<std::uint8_t, 256> sines() {
  std::array<std::uint8_t, 256> out{};
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint8_t>(
        std::lround(127.5 * (1 + std::sin(2 * std::numbers::pi * static_cast<double>(i) / 256))));
  return out;
}

std::int64_t whole_root(std::int64_t square) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
  while (root * root > square)
    --root;
  while ((root + 1) * (root + 1) <= square)
    ++root;
  return root;
}

/// A signed number of 18 bits.
std::int64_t coordinate(std::uint64_t word, int shift) {
  const auto bits = static_cast<std::int64_t>(word >> shift & 0x3ffff);
  return bits >= 0x20000 ? bits - 0x40000 : bits;
}

}  // namespace

EmulatedUnit::EmulatedUnit(std::uint8_t protocol) : protocol_(protocol) {
  power_up();
}

void EmulatedUnit::power_up() {
  for (auto& words : patterns_)
    words.assign(pattern_words, 0);
  for (auto& samples : modulations_)
    samples.assign(modulation_bytes, 255);
  playing_ = {};
  modulating_ = {};
  for (Plan& plan : modulating_.planned)
    plan.size = 2;
  modulating_.now.plan.size = 2;
  correction_.fill(0);
  on_.fill(true);
  for (std::size_t i = 0; i < widths_.size(); ++i)
    widths_[i] =
        static_cast<std::uint16_t>(std::lround(512 * std::asin(static_cast<double>(i) / 255) / std::numbers::pi));
  strict_ = false;
  intensity_steps_ = 10;
  phase_steps_ = 40;
  failsafe_s_ = protocol_ == 5 ? 0 : default_failsafe_s;
  shut_ = unguarded_told_ = false;
  queue_full_ = repeated_ = out_of_order_ = errors_ = carried_out_ = late_ = 0;
  failsafes_ = 0;
}

std::uint32_t EmulatedUnit::execute_at_us(std::span<const std::uint8_t> frame) const {
  return protocol_ == 2 ? 0 : u32(frame, 2);
}

bool EmulatedUnit::repeats_last(std::span<const std::uint8_t> frame) const {
  return protocol_ != 5 && last_command_ >= 0 && frame[0] == ack_ && frame[1] == last_command_;
}

void EmulatedUnit::host_spoke(double now_s) {
  if (failsafe_shut(now_s) && !shut_) {
    shut_ = true;
    ++failsafes_;
  }
  host_spoke_s_ = now_s;
}

void EmulatedUnit::queue_was_full(double now_s) {
  ++queue_full_;
  violate(now_s, "a frame came while seven were waiting, and is lost");
}

bool EmulatedUnit::failsafe_shut(double now_s) const {
  return shut_ || (failsafe_s_ > 0 && host_spoke_s_ && now_s - *host_spoke_s_ > failsafe_s_);
}

EmulatedUnit::Result EmulatedUnit::carry_out(Moment at, std::span<const std::uint8_t> frame, bool late) {
  const std::uint8_t sequence = frame[0], command = frame[1];
  const std::span<const std::uint8_t> payload = frame.subspan(head_size());
  if (protocol_ != 5) {
    if (command == 0x00) {  // Reset: the count begins at 0 again
      expected_ = 0;
      ack_ = 0xff;
      last_command_ = -1;
      result_ = {ack_, fine, {}};
      return result_;
    }
    if (repeats_last(frame)) {
      ++repeated_;
      return result_;
    }
    if (sequence != expected_) {
      ++out_of_order_;
      violate(at.now_s, fmt::format("frame {} of command 0x{:02x} where {} was expected: not carried out", sequence,
                                    command, expected_));
      return result_;
    }
    ++expected_;
    ack_ = sequence;
    last_command_ = command;
  } else if (sequence != 0) {
    violate(at.now_s, fmt::format("the first byte of a frame is {}, not 0", sequence));
  }
  if (late) ++late_;
  std::vector<std::uint8_t> data;
  const bool told = command >= 0x80;  // what only asks
  if (!cleared_ && !told && command != 0x03 && command != 0x01 && command != 0x04 && command != 0x06)
    violate(at.now_s, fmt::format("command 0x{:02x} before a Clear", command));
  const std::uint8_t status = handle(at, command, payload, data);
  if (status == fine) {
    ++carried_out_;
  } else {
    ++errors_;
    violate(at.now_s,
            fmt::format("status {:02x} in answer to command 0x{:02x} of {} bytes", status, command, payload.size()));
  }
  if (failsafe_s_ == 0 && !unguarded_told_ && !silent(at)) {
    unguarded_told_ = true;
    violate(at.now_s, "it sounds while its failsafe is off: it will go on if its host dies");
  }
  result_ = {protocol_ == 5 ? std::uint8_t{0} : ack_, status, std::move(data)};
  return result_;
}

std::uint8_t EmulatedUnit::handle(Moment at, std::uint8_t command, std::span<const std::uint8_t> p,
                                  std::vector<std::uint8_t>& data) {
  const bool bare = p.empty();
  switch (command) {
    case 0x01:  // Synchronize
    case 0x04:  // Nop
      return bare ? fine : bad_payload;
    case 0x03:
      if (!bare) return bad_payload;
      power_up();
      cleared_ = true;
      return fine;
    case 0x05:
      return set_cpu(p);
    case 0x06:
      if (!bare) return bad_payload;
      shut_ = false;
      return fine;
    case 0x10:
      return write_words(p);
    case 0x11:
      return configure_pattern(p);
    case 0x12:
      return activate(at, playing_, p);
    case 0x13:
      return write_phases(p);
    case 0x15:
      return write_raw(p);
    case 0x16:
      return protocol_ == 2 ? unknown_command : play_at_once(at, p);
    case 0x20:
      return write_modulation(p);
    case 0x21:
      return configure_modulation(p);
    case 0x22:
      return activate(at, modulating_, p);
    case 0x30:
      return set_silencer(p);
    case 0x40:
      if (p.size() != correction_.size()) return bad_payload;
      std::ranges::copy(p, correction_.begin());
      return fine;
    case 0x41:
      if (p.size() != 32) return bad_payload;
      for (std::size_t t = 0; t < transducers; ++t)
        on_[t] = (u16(p, 2 * (t / 16)) >> (t % 16) & 1) != 0;
      return fine;
    case 0x42:
      if (p.size() != 2 * widths_.size()) return bad_payload;
      for (std::size_t i = 0; i < widths_.size(); ++i)
        widths_[i] = u16(p, 2 * i);
      return fine;
    case 0xe7:
      if (!bare) return bad_payload;
      data.push_back(state(at));
      return fine;
    case 0xe8:
      if (!bare) return bad_payload;
      put_counters(data);
      return fine;
    case 0xeb: {  // versions of CPU and FPGA, functions (80: an emulator), boot image
      if (!bare) return bad_payload;
      const std::uint8_t minor = protocol_ == 2 ? 11 : protocol_ == 3 ? 12 : 13;
      data = {0, minor, 0, 0, minor, 0, static_cast<std::uint8_t>(protocol_ == 5 ? 0xac : 0x8c), 2};
      return fine;
    }
    default:
      return unknown_command;
  }
}

/// 52 bytes in protocol 5; palpa sets only the failsafe. 2 and 3 take what they are sent, and this emulator ignores it.
std::uint8_t EmulatedUnit::set_cpu(std::span<const std::uint8_t> p) {
  if (protocol_ != 5) return p.size() == 66 || (protocol_ == 2 && p.size() == 64) ? fine : bad_payload;
  if (p.size() != 52) return bad_payload;
  failsafe_s_ = 1e-3 * u16(p, 34);
  return fine;
}

void EmulatedUnit::put_raw(std::uint8_t bank, std::size_t index, std::span<const std::uint8_t> bytes) {
  for (std::size_t t = 0; t < transducers; ++t) {
    const std::uint8_t phase = protocol_ == 5 ? bytes[2 * t] : bytes[t];
    const std::uint8_t intensity = protocol_ == 5 ? bytes[2 * t + 1] : bytes[transducers + t];
    patterns_[bank][words_of_raw * index + t] = static_cast<std::uint16_t>(phase | intensity << 8);
  }
}

std::uint8_t EmulatedUnit::write_raw(std::span<const std::uint8_t> p) {
  if (p.size() < 4 || p[0] > 1 || p[1] < 1 || p[1] > 2 || p.size() != 4 + raw_bytes * p[1]) return bad_payload;
  const std::size_t first = u16(p, 2);
  if (first + p[1] > most_raw) return bad_payload;
  for (std::size_t c = 0; c < p[1]; ++c)
    put_raw(p[0], first + c, p.subspan(4 + raw_bytes * c, raw_bytes));
  return fine;
}

std::uint8_t EmulatedUnit::write_phases(std::span<const std::uint8_t> p) {
  if (p.size() < 6 || p[0] > 1 || (p[1] != 8 && p[1] != 4)) return bad_payload;
  const std::size_t each = p[1] == 8 ? transducers : (transducers + 1) / 2, most = p[1] == 8 ? 5 : 11;
  const std::size_t count = p[2], first = u16(p, 4);
  if (count < 1 || count > most || p.size() != 6 + each * count || first + count > most_raw) return bad_payload;
  for (std::size_t c = 0; c < count; ++c) {
    const std::span<const std::uint8_t> phases = p.subspan(6 + each * c, each);
    for (std::size_t t = 0; t < transducers; ++t) {
      const unsigned phase = p[1] == 8 ? phases[t] : (phases[t / 2] >> (t % 2 == 0 ? 0 : 4) & 0xf) * 0x11u;
      patterns_[p[0]][words_of_raw * (first + c) + t] = static_cast<std::uint16_t>(phase | p[3] << 8);
    }
  }
  return fine;
}

/// Foci, as words of the pattern memory.
std::uint8_t EmulatedUnit::write_words(std::span<const std::uint8_t> p) {
  if (p.size() < 6 + 8 || p[0] > 1 || (p.size() - 6) % 8 != 0) return bad_payload;
  const std::size_t first = u32(p, 2), count = (p.size() - 6) / 2;
  if (first % 4 != 0 || first + count > pattern_words) return bad_payload;
  for (std::size_t w = 0; w < count; ++w)
    patterns_[p[0]][first + w] = u16(p, 6 + 2 * w);
  return fine;
}

std::uint8_t EmulatedUnit::write_modulation(std::span<const std::uint8_t> p) {
  if (p.size() < 7 || p[0] > 1) return bad_payload;
  const std::size_t first = u32(p, 2), count = p.size() - 6;
  if (first % 2 != 0 || first + count > modulation_bytes) return bad_payload;
  std::ranges::copy(p.subspan(6), modulations_[p[0]].begin() + static_cast<std::ptrdiff_t>(first));
  return fine;
}

std::uint8_t EmulatedUnit::configure_pattern(std::span<const std::uint8_t> p) {
  if (p.size() != 14 || p[0] > 1 || p[1] > 1) return bad_payload;
  const Plan plan{p[1] == 1, u16(p, 2), u32(p, 4), p[8], u16(p, 10), u16(p, 12)};
  if (plan.divider == 0) return bad_payload;
  if (plan.raw) {
    if (plan.size < 1 || plan.size > most_raw || (plan.size == 1 && plan.repeats != for_ever)) return bad_payload;
  } else if (plan.foci < 1 || plan.foci > 8 || plan.speed == 0 || plan.size < 2 ||
             plan.size > pattern_words / 4 / plan.foci) {
    return bad_payload;
  }
  playing_.planned[p[0]] = plan;
  return fine;
}

std::uint8_t EmulatedUnit::configure_modulation(std::span<const std::uint8_t> p) {
  if (p.size() != 10 || p[0] > 1) return bad_payload;
  Plan plan;
  plan.divider = u16(p, 2);
  plan.size = u32(p, 4);
  plan.repeats = u16(p, 8);
  if (plan.divider == 0 || plan.size < 2 || plan.size > modulation_bytes) return bad_payload;
  modulating_.planned[p[0]] = plan;
  return fine;
}

bool EmulatedUnit::too_fast(std::uint16_t pattern_divider, std::uint16_t modulation_divider) const {
  return strict_ && (modulation_divider < intensity_steps_ || pattern_divider < intensity_steps_ ||
                     pattern_divider < phase_steps_);
}

std::uint8_t EmulatedUnit::activate(Moment at, Player& player, std::span<const std::uint8_t> p) {
  if (p.size() != 10 || p[0] > 1) return bad_payload;
  const Plan& plan = player.planned[p[0]];
  const std::uint8_t mode = p[1];
  const std::uint64_t value = u64(p, 2);
  const bool patterns = &player == &playing_;
  if (too_fast(patterns ? plan.divider : playing_.at(at.unit_ns).plan.divider,
               patterns ? modulating_.at(at.unit_ns).plan.divider : plan.divider))
    return silencer_forbids;
  const bool endless = plan.repeats == for_ever;
  if (protocol_ != 5) {
    if (endless ? mode != at_once && mode != 0xf0 : mode != next_lap && mode != at_time && mode != 0x02)
      return bad_mode;
    if (mode == at_time && value < at.unit_ns + 10'000'000) return too_near;
  }
  if (mode == 0xf0 || mode == 0x02) {
    violate(at.now_s, fmt::format("activation mode {:02x}, which this emulator does not support", mode));
    return bad_mode;
  }
  if (player.next && at.unit_ns >= player.next->from_ns) player.now = *player.next;
  player.next.reset();
  Player::Turn turn{p[0], plan, at.unit_ns};
  if (endless || mode == at_once) {
    player.now = turn;
  } else {
    const std::uint64_t lap_ns = period_ns * player.now.plan.divider * player.now.plan.size;
    turn.from_ns = mode == at_time ? value : (at.unit_ns / lap_ns + 1) * lap_ns;
    player.next = turn;
  }
  return fine;
}

/// Writes one pattern and plays it for ever: what 15 or 13, 11 and 12 would do together.
std::uint8_t EmulatedUnit::play_at_once(Moment at, std::span<const std::uint8_t> p) {
  if (p.size() != 10 + raw_bytes || p[0] > 1) return bad_payload;
  if (protocol_ != 5 && p[1] != at_once && p[1] != 0xf0) return bad_mode;
  put_raw(p[0], 0, p.subspan(10));
  playing_.planned[p[0]] = {};
  playing_.next.reset();
  playing_.now = {p[0], {}, at.unit_ns};
  return fine;
}

std::uint8_t EmulatedUnit::set_silencer(std::span<const std::uint8_t> p) {
  if (p.size() != 10) return bad_payload;
  const bool before = std::exchange(strict_, (p[0] & 2) != 0);
  const std::uint16_t intensity = std::exchange(intensity_steps_, u16(p, 6)),
                      phase = std::exchange(phase_steps_, u16(p, 8));
  if (u16(p, 2) != 0 && u16(p, 4) != 0 && intensity_steps_ != 0 && phase_steps_ != 0) {
    if (!too_fast(playing_.now.plan.divider, modulating_.now.plan.divider)) return fine;
    strict_ = before;
    intensity_steps_ = intensity;
    phase_steps_ = phase;
    return silencer_forbids;
  }
  strict_ = before;
  intensity_steps_ = intensity;
  phase_steps_ = phase;
  return bad_payload;
}

std::size_t EmulatedUnit::Player::index(std::uint64_t unit_ns) const {
  const Turn& turn = at(unit_ns);
  if (turn.plan.repeats == for_ever) return unit_ns / period_ns / turn.plan.divider % turn.plan.size;
  const std::uint64_t step = (unit_ns - turn.from_ns) / period_ns / turn.plan.divider;
  return ended(unit_ns) ? turn.plan.size - 1 : step % turn.plan.size;
}

bool EmulatedUnit::Player::ended(std::uint64_t unit_ns) const {
  const Turn& turn = at(unit_ns);
  if (turn.plan.repeats == for_ever) return false;
  return (unit_ns - turn.from_ns) / period_ns / turn.plan.divider / turn.plan.size > turn.plan.repeats;
}

std::uint8_t EmulatedUnit::state(Moment at) const {
  unsigned bits = 0;
  if (modulating_.at(at.unit_ns).bank == 1) bits |= 0x02;
  if (playing_.at(at.unit_ns).bank == 1) bits |= 0x04;
  if (playing_.at(at.unit_ns).plan.size == 1) bits |= 0x08;
  if (playing_.ended(at.unit_ns)) bits |= 0x10;
  if (modulating_.ended(at.unit_ns)) bits |= 0x20;
  if (playing_.next && at.unit_ns < playing_.next->from_ns) bits |= 0x40;
  if (protocol_ != 5 && failsafe_shut(at.now_s)) bits |= 0x80;
  return static_cast<std::uint8_t>(bits);
}

void EmulatedUnit::put_counters(std::vector<std::uint8_t>& data) const {
  put(data, queue_full_, 4);
  if (protocol_ != 5) {
    put(data, repeated_, 4);
    put(data, out_of_order_, 4);
  }
  put(data, errors_, 4);
  put(data, carried_out_, 4);
  put(data, 0, 4);  // answers that could not be sent
  put(data, failsafes_, 2);
  put(data, 0, 5);
  if (protocol_ != 2) put(data, late_, 4);
}

EmulatedUnit::Outputs EmulatedUnit::of_foci(std::span<const std::uint64_t> foci, std::uint32_t speed) {
  static const auto where = places();
  static const auto sine = sines();
  Outputs out{};
  const auto intensity = static_cast<std::uint8_t>(foci[0] >> 54 & 0xff);
  for (std::size_t t = 0; t < transducers; ++t) {
    std::int64_t s = 0, c = 0;
    for (std::size_t f = 0; f < foci.size(); ++f) {
      const std::int64_t dx = coordinate(foci[f], 0) - where[t].x, dy = coordinate(foci[f], 18) - where[t].y,
                         dz = coordinate(foci[f], 36);
      const std::int64_t offset = f == 0 ? 0 : static_cast<std::int64_t>(foci[f] >> 54 & 0xff);
      const std::int64_t q = 16384 * whole_root(dx * dx + dy * dy + dz * dz) / speed + offset;
      s += sine[static_cast<std::size_t>(q % 256)];
      c += sine[static_cast<std::size_t>((q + 64) % 256)];
    }
    const auto count = static_cast<std::int64_t>(foci.size());
    const auto y = static_cast<double>(s / count / 2 - 64), x = static_cast<double>(c / count / 2 - 64);
    out[t] = {static_cast<std::uint8_t>(-std::lround(std::atan2(y, x) * 128 / std::numbers::pi) & 0xff), intensity};
  }
  return out;
}

EmulatedUnit::Outputs EmulatedUnit::sample(std::uint8_t bank, const Plan& plan, std::size_t index) const {
  const std::vector<std::uint16_t>& words = patterns_[bank];
  if (plan.raw) {
    Outputs out{};
    for (std::size_t t = 0; t < transducers; ++t) {
      const std::uint16_t word = words[words_of_raw * index + t];
      out[t] = {static_cast<std::uint8_t>(word & 0xff), static_cast<std::uint8_t>(word >> 8)};
    }
    return out;
  }
  std::array<std::uint64_t, 8> foci{};
  for (std::size_t f = 0; f < plan.foci; ++f) {
    for (std::size_t w = 0; w < 4; ++w)
      foci[f] |= std::uint64_t{words[4 * (plan.foci * index + f) + w]} << (16 * w);
  }
  return of_foci(std::span(foci).first(plan.foci), plan.speed);
}

EmulatedUnit::Outputs EmulatedUnit::pattern(Moment at) const {
  const Player::Turn& turn = playing_.at(at.unit_ns);
  Outputs out = sample(turn.bank, turn.plan, playing_.index(at.unit_ns));
  const bool shut = failsafe_shut(at.now_s);
  for (std::size_t t = 0; t < transducers; ++t) {
    out[t].phase = static_cast<std::uint8_t>(out[t].phase + correction_[t]);
    if (!on_[t] || shut) out[t].intensity = 0;
  }
  return out;
}

std::uint8_t EmulatedUnit::modulation(Moment at) const {
  return modulations_[modulating_.at(at.unit_ns).bank][modulating_.index(at.unit_ns)];
}

EmulatedUnit::Outputs EmulatedUnit::output(Moment at) const {
  Outputs out = pattern(at);
  const unsigned gain = modulation(at);
  for (Output& one : out)
    one.intensity = static_cast<std::uint8_t>(one.intensity * gain / 255);
  return out;
}

bool EmulatedUnit::silent(Moment at) const {
  const Outputs all = output(at);
  return std::ranges::all_of(all, [](const Output& one) { return one.intensity == 0; });
}

}  // namespace palpa::driver::autd3_udp
