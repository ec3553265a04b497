// How much of the requested pressures fingers got.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "base/files/json_writer.hpp"

namespace palpa::session {

/// One finger, over all frames that planned it.
struct FingerPressure {
  std::uint32_t id = 0, solid = 0;
  std::uint64_t frames = 0;
  double asked_pa = 0;  ///< the requested pressure times its gain, in its newest frame; 0: none
  double least_pa = 0, most_pa = 0, sum_pa = 0;
};

/// The member "fingers" of a document of statistics; writes nothing if there are none.
void write_pressures(std::span<const FingerPressure> fingers, std::span<const std::string> solid_names,
                     JsonWriter& json);

/// Whether at least 99 % of the requested pressure is reached. Requests below 1 mPa always count as reached.
constexpr bool is_reached(double asked_pa, double reached_pa) {
  return reached_pa >= 0.99 * asked_pa || asked_pa < 1e-3;
}

/// A sentence about the first finger of the schedule that does not reach its requested pressure, with the pressure that
/// it gets and why. Empty if all fingers reach theirs. `solid_names` by solid index.
std::optional<std::string> unreached(const array::Schedule& schedule, std::span<const std::string> solid_names,
                                     const char* why = "the array cannot give more");

/// Whether any voice has more pressure than linear acoustics holds for.
bool beyond_linear(const array::Schedule& schedule);

class PressureLog {
 public:
  /// Fingers beyond the first `most` are not kept.
  static constexpr std::size_t most = 256;
  explicit PressureLog(std::span<const std::string> solid_names) : solid_names_(solid_names) { fingers_.reserve(most); }

  /// Adds a frame's schedule. Warns once if a pressure is not reached. `played`: the same with the pressures that
  /// boards play, which count instead.
  void planned(const array::Schedule& schedule, const array::Schedule* played = nullptr);
  /// In the order of their first appearance.
  const std::vector<FingerPressure>& fingers() const { return fingers_; }

 private:
  std::span<const std::string> solid_names_;
  std::vector<FingerPressure> fingers_;
  bool warned_ = false;
};

}  // namespace palpa::session
