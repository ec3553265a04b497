// The same test body on both backends: the twin and the GPU.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::array {

struct Backend {
  const char* name;
  /// Drives of a batch of slots, in their order.
  std::vector<Drive> (*drives)(const Layout&, const std::vector<std::vector<SlotFocus>>&, const DriveOptions&);
  double phase_tolerance;  ///< rad, one focus within 2 m
  double sum_tolerance;    ///< of the amplitudes if several foci are summed; for phases: this divided by the amplitude
  Drive drive(const Layout& layout, const std::vector<SlotFocus>& foci, const DriveOptions& options = {}) const {
    return drives(layout, {foci}, options)[0];
  }
};

extern const Backend backends[2];

inline void PrintTo(const Backend& backend, std::ostream* out) {
  *out << backend.name;
}
inline std::string backend_name(const testing::TestParamInfo<Backend>& info) {
  return info.param.name;
}

inline constexpr Constraint constraints[] = {Constraint::normalise, Constraint::uniform, Constraint::clamp};
inline DriveOptions with(Solver solver, Constraint constraint = Constraint::normalise) {
  return {.constraint = constraint, .solver = solver};
}

/// The smaller of the two angles between `a` and `b`.
double angle_between(double a, double b);
/// Counts the values that no drive may have: NaN, infinite or out of range.
std::size_t faults(const Drive& drive);
bool same(std::span<const TransducerDrive> a, std::span<const TransducerDrive> b);
std::vector<std::vector<SlotFocus>> random_slots(std::size_t slots, std::size_t most_foci, unsigned seed);

}  // namespace palpa::array
