// A plan as AUTD3 devices play it: what each transducer emits in each part, and which part is due by the devices'
// clock.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "driver/autd3/wire.hpp"
#include "driver/board.hpp"

namespace palpa::driver::autd3 {

/// Devices count from 2000-01-01, as everything on EtherCAT does.
inline constexpr double epoch_s = 946684800;

class Pattern {
 public:
  /// Room for plans of that many transducers and parts.
  Pattern(std::size_t count, std::size_t most_parts);

  void encode(const BoardPlan& plan);
  void clear() { parts_ = 0; }
  bool empty() const { return parts_ == 0; }

  std::uint32_t parts() const { return parts_; }
  /// Whether all transducers of all parts are at full amplitude.
  bool full() const { return full_; }
  /// Whether all transducers of each part have one intensity.
  bool even() const { return even_; }
  /// One focus per part, if each part is one focus; else empty.
  std::span<const Vec3> foci() const { return std::span(foci_).first(foci_count_); }
  std::span<const Emission> part(std::uint64_t index) const {
    return {&emissions_[index * transducers_], transducers_};
  }
  std::uint64_t until_slot() const { return until_slot_; }
  double modulation_hz() const { return modulation_hz_; }
  array::Modulation modulation() const { return modulation_; }
  double slot_s() const { return slot_s_; }
  /// When slot 0 began, on CLOCK_MONOTONIC.
  double begin_s() const { return begin_s_; }

 private:
  std::size_t transducers_;
  std::vector<Emission> emissions_;
  std::vector<Vec3> foci_;
  std::size_t foci_count_ = 0;
  std::uint32_t parts_ = 0;
  bool full_ = false, even_ = false;
  std::uint64_t until_slot_ = 0;
  double modulation_hz_ = 0, slot_s_ = 0, begin_s_ = 0;
  array::Modulation modulation_ = array::Modulation::pressure_sine;
};

/// A focus in the units of a device, board number `device` of the layout.
FixedPoint fixed_point(const Vec3& focus, const array::Layout& layout, std::size_t device);
/// Whether devices can compute these drives from their foci: one amplitude for each drive, and foci within reach.
bool can_be_foci(const Pattern& pattern, const array::Layout& layout, double sound_speed_m_s);

/// The periods of a slot. Throws bad_usage if they are not whole, or too many.
std::uint16_t divider_of(double slot_s, std::string_view link = "autd3");

/// How far the devices' count of parts is ahead of the loop's count of slots. Both advance alike, so the number stays
/// the same for a long time: it changes only when the two have drifted apart by a whole slot. Devices are assumed to
/// have this machine's time of day. If theirs is different, a pattern begins at another part, but repeats all the same.
class PartOffset {
 public:
  /// `day_s` is the time of day, since 1970, when CLOCK_MONOTONIC shows 0.
  void follow(double begin_s, double slot_s, double day_s);
  /// Which of the plan's `parts` parts the devices play at their part number `index`.
  std::uint32_t part_at(std::uint32_t index, std::uint32_t parts) const;

 private:
  std::int64_t ahead_ = 0;
  bool known_ = false;
};

/// One modulation as devices play it: samples of `divider` periods each (BoardType::modulation_slot_s), in whole cycles
/// as near to `hz` as 254 samples allow.
struct ModulationSamples {
  std::uint16_t divider = 10;
  std::size_t count = 0;
  std::array<std::uint8_t, 254> samples{};
};
/// `hz` 0: full amplitude. `begin_s` and `day_s` are as above. Sample 0 sounds at multiples of the total length on the
/// devices' clock.
ModulationSamples modulation_samples(double hz, array::Modulation modulation, double begin_s, double day_s,
                                     double now_s);

}  // namespace palpa::driver::autd3
