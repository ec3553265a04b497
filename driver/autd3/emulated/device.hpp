// An emulated AUTD3 device. It reads messages as firmware 12.1 does, and says what its transducers emit. It is as
// strict as the firmware, but reports more. A violation is a message that the firmware answers with an error, or one
// that it accepts silently although no program can have intended it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "driver/emulate/violations.hpp"

namespace palpa::driver::autd3 {

class EmulatedDevice {
 public:
  static constexpr std::size_t transducers = 249, message_size = 626;

  struct Output {
    std::uint8_t phase, intensity;
    bool operator==(const Output&) const = default;
  };

  explicit EmulatedDevice(std::uint8_t firmware = 0xa5);

  /// `now_s` is the time since 2000-01-01: messages take effect then.
  void receive(double now_s, std::span<const std::uint8_t> message);
  /// The phases that the firmware computes for a focus at x, y, z (0.025 mm, from transducer 0). c is the sound speed
  /// times 64. Computed in whole numbers, with the firmware's tables of 256 sines and 128 x 128 angles.
  static std::array<std::uint8_t, transducers> phases_of_focus(std::int32_t x, std::int32_t y, std::int32_t z,
                                                               std::uint32_t c);
  /// The two bytes of the answer: first the data, then the error and the number.
  std::array<std::uint8_t, 2> answer() const;

  /// What its transducers emit at that time: the current part of the pattern times the modulation.
  std::array<Output, transducers> output(double now_s) const;
  bool silent(double now_s) const;
  /// Whether both of its pattern memories are silent, so that nothing sounds after a switch either.
  bool empty() const;
  bool cleared() const { return cleared_; }
  /// How many periods its silencer takes for a change of phases, and of amplitudes.
  std::uint16_t phase_steps() const { return phase_steps_; }
  std::uint16_t intensity_steps() const { return intensity_steps_; }
  /// Operations that it has understood, and transitions from one segment to the other.
  std::uint64_t operations() const { return operations_; }
  std::uint64_t transitions() const { return transitions_; }
  const emulate::Violations& violations() const { return violations_; }

 private:
  struct Segment {
    std::vector<std::array<Output, transducers>> parts;
    std::uint32_t divider = 0xffff;
    bool open = false;  ///< begun but not ended
    bool foci = false;  ///< the device has computed its phases
  };
  struct Waveform {
    std::vector<std::uint8_t> samples;
    std::uint32_t divider = 0xffff;
  };

  void power_up();
  std::uint8_t handle(std::span<const std::uint8_t> operation);
  std::uint8_t tell_version(std::uint8_t which);
  std::uint8_t take_modulation(std::span<const std::uint8_t> o);
  std::uint8_t take_silencer(std::span<const std::uint8_t> o);
  std::uint8_t take_gain(std::span<const std::uint8_t> o);
  std::uint8_t take_pattern(std::span<const std::uint8_t> o);
  std::uint8_t take_foci(std::span<const std::uint8_t> o);
  std::uint8_t change_pattern(std::span<const std::uint8_t> o, bool foci);
  bool too_fast(std::uint32_t pattern_divider, std::uint32_t modulation_divider) const;
  bool wrong_transition(std::uint8_t current, std::uint8_t segment, std::uint16_t repeat, std::uint8_t mode) const;
  void violate(const std::string& what) { violations_.add(now_s_, what); }

  std::uint8_t firmware_;
  double now_s_ = 0;
  int id_ = -1;
  std::uint8_t error_ = 0, data_ = 0;
  bool cleared_ = false, synchronised_ = false;
  std::array<Segment, 2> segments_;
  std::array<Waveform, 2> waveforms_;
  std::uint8_t sounding_ = 0, heard_ = 0;  ///< segments of pattern and modulation
  std::uint8_t writing_ = 0, mode_ = 0;
  bool strict_ = true;
  std::uint16_t intensity_steps_ = 10, phase_steps_ = 40;
  std::uint64_t operations_ = 0, transitions_ = 0;
  emulate::Violations violations_;
};

}  // namespace palpa::driver::autd3
