// What AUTD3 units of the UDP line are sent, and what they answer (makers' releases 0.10 to 0.13). A datagram is
//
//   u8 protocol byte, u8 kind, u16 message id; the body of that kind
//
// and its answer repeats kind and id. The body of a frame is a head, a command and what that command asks for. Releases
// differ in their protocol byte and in what it means: Protocol is one column of that table. Numbers are little-endian.
// docs/notes/board-wires.md has the bytes of one frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "driver/autd3/wire.hpp"

namespace palpa::driver::autd3_udp {

using autd3::Emission;
using autd3::FixedPoint;
using autd3::transducers;

/// What one protocol byte means.
struct Protocol {
  std::uint8_t byte;
  std::string_view firmware;  ///< the series that speaks it, for people
  std::uint8_t minor_from;    ///< ... and its versions: 0.minor_from to 0.minor_to
  std::uint8_t minor_to;
  bool counts_frames;           ///< frames have a sequence number, and Reset begins it again
  bool carries_time;            ///< a frame may be carried out at a time, and command 16 exists
  bool pairs;                   ///< a raw pattern is pairs of phase and intensity, else first all phases
  bool has_settings;            ///< command 05 is needed: its failsafe is off by default
  bool failsafe_flag;           ///< flag 40 says that the failsafe has shut; else bit 80 of the state (e7) does
  std::uint8_t least_info;      ///< bytes of a unit's info
  std::uint8_t least_counters;  ///< bytes of its counters (e8)

  std::size_t head() const { return carries_time ? 6 : 2; }  ///< of a frame
};
std::span<const Protocol> protocols();
/// Null: unknown.
const Protocol* find_protocol(std::uint8_t byte);
/// "2 (firmware 0.10 and 0.11), 3 ...".
std::string known_protocols();

inline constexpr std::uint16_t unit_port = 44336;
inline constexpr std::uint8_t ask_byte = 0xff;  ///< no unit has it, so each answers with its own
inline constexpr std::uint8_t no_id = 0xff;
inline constexpr std::size_t most_units = 128;
inline constexpr std::size_t most_body = 1448, datagram_head = 4, most_datagram = datagram_head + most_body;
/// What the cable carries besides a datagram's own bytes, in bytes, and how fast it is.
inline constexpr std::size_t cable_overhead = 86;
inline constexpr double cable_bytes_per_s = 100e6 / 8;
inline constexpr std::size_t queue_size = 7;  ///< frames that a unit takes before it carries them out

enum class Kind : std::uint8_t {
  frame = 0,
  info = 1,
  reset_id = 2,
  discover = 3,
  assign = 4,
  open_far_port = 5,
  set_time = 6,
  heartbeat = 7,
};

enum class Command : std::uint8_t {
  reset = 0x00,  ///< only where frames are counted
  synchronize = 0x01,
  clear = 0x03,
  settings = 0x05,
  release_failsafe = 0x06,
  write_foci = 0x10,
  configure_pattern = 0x11,
  activate_pattern = 0x12,
  write_phases = 0x13,
  write_raw = 0x15,
  pattern_at_once = 0x16,
  write_modulation = 0x20,
  configure_modulation = 0x21,
  activate_modulation = 0x22,
  silencer = 0x30,
  phase_correction = 0x40,
  mask = 0x41,
  read_state = 0xe7,
  read_counters = 0xe8,
  read_versions = 0xeb,
};

enum Flag : std::uint8_t {
  has_id = 0x01,
  far_port_open = 0x02,
  far_port_link = 0x04,
  pulse_runs = 0x08,
  clock_locked = 0x10,
  first_unit = 0x20,
  failsafe_shut = 0x40,
};
/// A bit of the state that e7 reads.
inline constexpr std::uint8_t state_failsafe = 0x80;

inline constexpr std::uint8_t status_ok = 0, status_wrong_protocol = 1;  ///< both of datagrams and of frames: ok
inline constexpr std::uint8_t status_sync_missed = 0x14;                 ///< of a frame: send it again
/// What a frame's status means, for people; without "status".
std::string_view frame_status(std::uint8_t status);

/// One datagram, from its protocol byte on.
struct Datagram {
  std::array<std::uint8_t, most_datagram> bytes;
  std::size_t size = 0;
  std::span<const std::uint8_t> view() const { return {bytes.data(), size}; }
  Command command() const { return static_cast<Command>(bytes[datagram_head + 1]); }
};

// Requests that are no frames. `protocol` is the byte of the units, or ask_byte for info.
void put_request(Datagram& to, std::uint8_t protocol, Kind kind, std::uint16_t id);
void put_assign(Datagram& to, const Protocol& protocol, std::uint16_t id, std::uint8_t unit);
void put_set_time(Datagram& to, const Protocol& protocol, std::uint16_t id, std::uint64_t ns);

// Each of the following functions writes a whole frame, except for what stamp() sets.
struct Stamp {
  std::uint16_t id = 0;
  std::uint8_t sequence = 0;  ///< where frames are counted
  std::uint32_t exec_at = 0;  ///< where frames carry a time; 0: at once
};
void stamp(Datagram& frame, const Protocol& protocol, const Stamp& stamp);
/// When a unit whose clock shows `ns` carries out such a frame: whole microseconds, never 0.
std::uint32_t exec_at(double ns);

/// A command that asks for nothing more.
void put_command(Datagram& to, const Protocol& protocol, Command command);
/// The units' own settings, with this time without a frame or heartbeat until they fall silent.
void put_settings(Datagram& to, const Protocol& protocol, std::uint16_t failsafe_ms);
/// Writes a pattern into a bank, which then sounds. Only where frames carry a time. Without emissions: silence.
void put_pattern_at_once(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::span<const Emission> pattern);
/// How many raw patterns one frame takes, and a bank.
inline constexpr std::size_t raw_in_frame = 2, most_raw = 1024;
/// Writes one or two patterns from number `first` of the bank on. Without emissions: one, of silence.
void put_raw(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint16_t first,
             std::span<const Emission> patterns);
/// The same for up to 5 patterns of which all transducers have one intensity.
inline constexpr std::size_t phases_in_frame = 5;
void put_phases(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint16_t first,
                std::span<const Emission> patterns);
/// How many foci one frame takes, and a bank.
std::size_t foci_in_frame(const Protocol& protocol);
inline constexpr std::size_t most_foci = 65536;
/// Writes foci from number `first` of the bank on.
void put_foci(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint32_t first,
              std::span<const FixedPoint> foci);
/// How a bank plays, from its next activation on: for ever, `size` samples of `divider` periods each.
struct BankPlay {
  std::uint16_t divider = 0xffff;
  std::uint32_t size = 1;
  std::uint8_t foci_a_sample = 0;  ///< 0: raw patterns
  double sound_speed_m_s = 0;      ///< for foci
};
void put_configure_pattern(Datagram& to, const Protocol& protocol, std::uint8_t bank, const BankPlay& play);
/// `what`: activate_pattern or activate_modulation.
void put_activate(Datagram& to, const Protocol& protocol, Command what, std::uint8_t bank);
/// How many samples of a modulation one frame takes, and a bank. Both even.
std::size_t samples_in_frame(const Protocol& protocol);
inline constexpr std::size_t most_samples = 65536;
void put_modulation(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint32_t first,
                    std::span<const std::uint8_t> samples);
void put_configure_modulation(Datagram& to, const Protocol& protocol, std::uint8_t bank, std::uint16_t divider,
                              std::uint32_t size);
/// A change takes that many periods. Strict: a pattern or modulation that changes faster is refused.
struct Silencer {
  std::uint16_t amplitude_steps = 10, phase_steps = 40;
  bool strict = false;
  std::uint16_t fixed_rate = 0;  ///< not 0: changes by that much a period, whatever the steps
};
void put_silencer(Datagram& to, const Protocol& protocol, const Silencer& silencer);
/// Phases that a unit adds to those of all patterns, in 1/256 turns.
void put_phase_correction(Datagram& to, const Protocol& protocol, std::span<const std::uint8_t> phases);
/// Transducers that are to sound.
void put_mask(Datagram& to, const Protocol& protocol, const std::array<bool, transducers>& on);

/// What a unit answered.
struct Answer {
  std::uint8_t protocol = 0;
  Kind kind = Kind::frame;
  std::uint16_t id = 0;
  std::uint8_t status = 0;
  // Only in answers to frames, heartbeats and info:
  std::uint8_t sequence = 0;  ///< of the last frame that was carried out, where frames are counted
  std::uint8_t flags = 0;
  std::uint8_t unit = no_id;
  std::uint64_t time_ns = 0;             ///< not of info
  std::span<const std::uint8_t> data{};  ///< what the kind or the command reads
};
/// Nothing if it is no answer, or too short for its kind.
std::optional<Answer> parse_answer(std::span<const std::uint8_t> datagram);

struct Version {
  std::uint8_t major = 0, minor = 0, patch = 0;
};
struct Versions {
  Version cpu, fpga;
};
std::optional<Versions> parse_versions(const Answer& answer);
/// How many frames came after their time; nothing: the answer is too short.
std::optional<std::uint32_t> parse_late(const Answer& answer, const Protocol& protocol);

}  // namespace palpa::driver::autd3_udp
