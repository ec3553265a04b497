// What AUTD3 devices are sent: messages of 626 bytes, one per device and step, and how they are sent over TCP (the
// Remote protocol of autd3-rs 38, version 1). All numbers are little-endian.
//
//   message      u8 id 0..15 (a repeated one is ignored), u8 0, u16 offset of a second operation or 0; 622 bytes
//   operation    u8 tag, then what the tag asks for
//   answer       u8 data, u8 acknowledge = error << 4 | id
//
//   request      0x10 hello u16 version "AUTD3REMOTE" | 0x01 geometry | 0x03 send, a message per device | 0x04 read |
//                0x05 close
//   reply        0x00, after a read an answer per device; or 0xff u32 size, text
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "array/transducer_drive.hpp"

namespace palpa::driver::autd3 {

inline constexpr std::size_t transducers = 249;  ///< of a device
inline constexpr double period_hz = 40e3;        ///< the frequency that its dividers divide
inline constexpr std::size_t header_size = 4, payload_size = 622, message_size = header_size + payload_size;
inline constexpr std::size_t answer_size = 2;
inline constexpr std::uint8_t most_id = 0x0f;
using Message = std::span<std::uint8_t, message_size>;

enum class Request : std::uint8_t { geometry = 0x01, send = 0x03, read = 0x04, close = 0x05, hello = 0x10 };
inline constexpr std::uint8_t reply_ok = 0x00, reply_error = 0xff;
inline constexpr std::array<std::uint8_t, 14> hello_request{0x10, 1,   0,   'A', 'U', 'T', 'D',
                                                            '3',  'R', 'E', 'M', 'O', 'T', 'E'};

/// The number of the firmware that palpa knows: 0xa5 is 12.1.
inline constexpr std::uint8_t known_firmware = 0xa5;
enum class Version : std::uint8_t { cpu_major = 1, cpu_minor, fpga_major, fpga_minor, fpga_functions, done };

/// One transducer's output in the devices' units: delay in 1/256 turns, and an intensity of 0 to 255, which selects a
/// pulse width (array/layouts/board_types.cpp).
struct Emission {
  std::uint8_t phase, intensity;
  bool operator==(const Emission&) const = default;
};
/// The highest amplitude of the board's record that is not above the drive's.
Emission emission(array::TransducerDrive drive);

/// Each writes one operation over the whole payload, with a header that has no second operation.
void put_nop(Message message);
/// Resets to the state after power-up and synchronises the clocks: two operations.
void put_clear_and_sync(Message message);
void put_version(Message message, Version which);
/// A change takes `intensity_steps` periods for amplitudes, and `phase_steps` for phases. Patterns that change faster
/// are refused.
void put_silencer(Message message, std::uint16_t intensity_steps, std::uint16_t phase_steps);
/// Writes a segment, which sounds at once.
void put_gain(Message message, std::uint8_t segment, std::span<const Emission> emissions);
/// Sets all transducers to zero.
void put_silence(Message message, std::uint8_t segment);
/// Writes the samples of a modulation into a segment, which is heard at once. At most 254 samples, each `divider`
/// periods long.
void put_modulation(Message message, std::uint8_t segment, std::uint16_t divider,
                    std::span<const std::uint8_t> samples);

/// A part of a pattern that a device plays by its own clock. Each part is `divider` periods long: the device plays part
/// floor(t * 40 kHz / divider) modulo the number of parts, with t since 2000-01-01. The parts go into a segment that
/// does not sound. The transition comes with the last part.
struct PatternStep {
  std::uint8_t segment = 0;
  std::uint16_t divider = 0;
  bool first = false, last = false;
};
void put_pattern(Message message, const PatternStep& step, std::span<const Emission> part);
/// One or two parts whose transducers are all at full amplitude.
void put_pattern_phases(Message message, const PatternStep& step, std::span<const Emission> part,
                        std::span<const Emission> next);

/// A focus in a device's units: 0.025 mm, from its transducer 0, along its own axes. Each value fits into 18 bits with
/// the sign.
struct FixedPoint {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint8_t intensity = 255;
};
inline constexpr double fixed_unit_m = 0.025e-3;
inline constexpr double sound_speed_steps = 64;  ///< in which a device gets the sound speed, per m/s
/// The highest sound speed that a device can be sent, in 16 bits.
inline constexpr double most_sound_speed_m_s = 65535 / sound_speed_steps;
/// How many foci one message takes.
inline constexpr std::size_t most_foci = 72;
/// Whether a device can take the focus: its computation does not overflow.
bool within_reach(const FixedPoint& focus);
/// Writes a whole pattern at once into a segment that does not sound, with the transition: the foci one after the
/// other, all transducers at the focus' intensity. The device computes the phases.
void put_foci(Message message, std::uint8_t segment, std::uint16_t divider, double sound_speed_m_s,
              std::span<const FixedPoint> foci);

void set_id(Message message, std::uint8_t id);

}  // namespace palpa::driver::autd3
