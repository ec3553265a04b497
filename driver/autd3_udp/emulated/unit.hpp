// The firmware of one emulated AUTD3 unit of the UDP line: it carries out frames, and says what its transducers emit.
// Written from the wire's description, without any code of the link. EmulatedChain has the network in front of it.
//
// It is as strict as the firmware, but reports more. A violation is a frame that the firmware answers with an error, or
// one that it accepts although no program can have intended it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "driver/emulate/violations.hpp"

namespace palpa::driver::autd3_udp {

/// A moment on the emulator's clock, and what the unit's own clock then shows.
struct Moment {
  double now_s = 0;           ///< the emulator's time; never goes back
  std::uint64_t unit_ns = 0;  ///< jumps when the host sets it
};

class EmulatedUnit {
 public:
  static constexpr std::size_t transducers = 249;

  struct Output {
    std::uint8_t phase = 0, intensity = 0;
    bool operator==(const Output&) const = default;
  };
  using Outputs = std::array<Output, transducers>;

  /// What a frame is answered with, beside the unit's flags, id and time.
  struct Result {
    std::uint8_t ack = 0, status = 0;
    std::vector<std::uint8_t> data;
  };

  /// `protocol` is 2 (releases 0.10 and 0.11), 3 (0.12) or 5 (0.13).
  explicit EmulatedUnit(std::uint8_t protocol);

  /// The bytes of a frame before its payload. Frames that are shorter are not answered.
  std::size_t head_size() const { return protocol_ == 2 ? 2 : 6; }
  /// When the frame is to be carried out, in microseconds of the unit's clock modulo 2^32; 0: at once.
  std::uint32_t execute_at_us(std::span<const std::uint8_t> frame) const;
  /// Whether this frame repeats the one before it (2 and 3): it is then not carried out again.
  bool repeats_last(std::span<const std::uint8_t> frame) const;

  /// Carries out a frame of at least head_size() bytes. `late`: after the moment that it names.
  Result carry_out(Moment at, std::span<const std::uint8_t> frame, bool late = false);
  /// What a heartbeat is answered with.
  Result last_result() const { return {ack_, result_.status, {}}; }
  /// A frame or heartbeat has arrived, so the failsafe's time begins again.
  void host_spoke(double now_s);
  void queue_was_full(double now_s);

  /// What its transducers emit: phase after correction; intensity after mask, modulation and failsafe. The silencer is
  /// not applied.
  Outputs output(Moment at) const;
  /// The same before the modulation, and the modulation's present value.
  Outputs pattern(Moment at) const;
  std::uint8_t modulation(Moment at) const;
  /// The width of the pulse for an intensity, in 512ths of a period.
  std::uint16_t pulse_width(std::uint8_t intensity) const { return widths_[intensity]; }
  bool silent(Moment at) const;
  bool failsafe_shut(double now_s) const;
  /// In seconds; 0: off.
  double failsafe_s() const { return failsafe_s_; }
  std::uint64_t carried_out() const { return carried_out_; }
  std::uint64_t late() const { return late_; }
  const emulate::Violations& violations() const { return violations_; }
  void violate(double now_s, std::string what) { violations_.add(now_s, std::move(what)); }

  /// The phases that the firmware computes for one sample of foci: words of 64 bits, speed in 64ths of m/s. In whole
  /// numbers, with the firmware's table of 256 sines.
  static Outputs of_foci(std::span<const std::uint64_t> foci, std::uint32_t speed);

 private:
  /// How a bank plays. Frames change it; it counts from the next activation.
  struct Plan {
    bool raw = true;
    std::uint16_t divider = 0xffff;
    std::uint32_t size = 1;
    std::uint8_t foci = 0;  ///< in a sample
    std::uint16_t speed = 0;
    std::uint16_t repeats = 0xffff;  ///< less one; ffff: for ever
  };
  /// What one of the two memories, of patterns or of modulation, does.
  struct Player {
    std::array<Plan, 2> planned;
    struct Turn {
      std::uint8_t bank = 0;
      Plan plan;
      std::uint64_t from_ns = 0;
    };
    Turn now;
    std::optional<Turn> next;  ///< waits for its moment

    const Turn& at(std::uint64_t unit_ns) const { return next && unit_ns >= next->from_ns ? *next : now; }
    std::size_t index(std::uint64_t unit_ns) const;
    bool ended(std::uint64_t unit_ns) const;
  };

  void power_up();
  std::uint8_t handle(Moment at, std::uint8_t command, std::span<const std::uint8_t> payload,
                      std::vector<std::uint8_t>& data);
  std::uint8_t write_raw(std::span<const std::uint8_t> p);
  std::uint8_t write_phases(std::span<const std::uint8_t> p);
  std::uint8_t write_words(std::span<const std::uint8_t> p);
  std::uint8_t write_modulation(std::span<const std::uint8_t> p);
  std::uint8_t configure_pattern(std::span<const std::uint8_t> p);
  std::uint8_t configure_modulation(std::span<const std::uint8_t> p);
  std::uint8_t activate(Moment at, Player& player, std::span<const std::uint8_t> p);
  std::uint8_t play_at_once(Moment at, std::span<const std::uint8_t> p);
  std::uint8_t set_silencer(std::span<const std::uint8_t> p);
  std::uint8_t set_cpu(std::span<const std::uint8_t> p);
  void put_raw(std::uint8_t bank, std::size_t index, std::span<const std::uint8_t> bytes);
  bool too_fast(std::uint16_t pattern_divider, std::uint16_t modulation_divider) const;
  std::uint8_t state(Moment at) const;
  void put_counters(std::vector<std::uint8_t>& data) const;
  Outputs sample(std::uint8_t bank, const Plan& plan, std::size_t index) const;

  std::uint8_t protocol_;
  // 2 and 3 count the frames.
  std::uint8_t expected_ = 0, ack_ = 0xff;
  int last_command_ = -1;
  Result result_;

  std::array<std::vector<std::uint16_t>, 2> patterns_;
  std::array<std::vector<std::uint8_t>, 2> modulations_;
  Player playing_, modulating_;
  std::array<std::uint8_t, transducers> correction_{};
  std::array<bool, transducers> on_{};
  std::array<std::uint16_t, 256> widths_{};
  bool strict_ = false;
  std::uint16_t intensity_steps_ = 10, phase_steps_ = 40;

  double failsafe_s_ = 0;
  std::optional<double> host_spoke_s_;
  bool shut_ = false, unguarded_told_ = false, cleared_ = false;
  std::uint32_t queue_full_ = 0, repeated_ = 0, out_of_order_ = 0, errors_ = 0, carried_out_ = 0, late_ = 0;
  std::uint16_t failsafes_ = 0;
  emulate::Violations violations_;
};

}  // namespace palpa::driver::autd3_udp
