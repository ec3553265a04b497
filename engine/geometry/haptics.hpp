// How an object feels, as its author defined it in the model.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::geometry {

/// A burst of vibration when a finger begins to press, and another one when it no longer presses.
struct Click {
  double burst_s = 0.045;  ///< 0.03 to 0.06; 0: no click, although an ancestor has one
  double hz = 200;         ///< 150 to 200
  bool operator==(const Click&) const = default;
};

/// A row of a table of stiffness: the share of the full force (radiation pressure) at a depth.
struct DepthForce {
  double depth_m = 0;  ///< 0 to 1, ascending from row to row
  double force = 1;    ///< 0 to 1
  bool operator==(const DepthForce&) const = default;
};

/// Between two rows, the force changes evenly; before the first and beyond the last, it stays. 1 without rows.
double force_at(std::span<const DepthForce> table, double depth_m);

/// The most rows of such a table.
inline constexpr std::size_t most_stiffness_rows = 32;

inline constexpr double default_grain_m = 2e-3;

/// A click of this length and frequency; nullopt if they are not two numbers in its ranges.
std::optional<Click> click_of(std::span<const double> numbers);
/// What is wrong with a row that follows the rows `before` in a table of stiffness; empty if nothing is.
std::string row_fault(std::span<const DepthForce> before, const DepthForce& row);
/// The weights of a texture; nullopt if they are not three numbers in its range.
std::optional<std::array<double, 3>> texture_of(std::span<const double> numbers);

/// Read from the `extras` of a glTF node, where modelling programs keep their custom properties (docs/scenes.md). An
/// empty optional means the session's value. Ranges are checked when the model is read. That foci and stride have no
/// common divisor is only checked if the model gives both.
struct Haptics {
  bool touchable = true;                ///< false: scenery, which becomes no solid and need not be closed
  std::optional<double> delta_m;        ///< thickness of the shell, metres: above 0, at most 0.1
  std::optional<double> dwell_s;        ///< how long a focus lasts, seconds: 1e-6 to 10
  std::optional<double> intensity;      ///< of this object's foci: 0 (silent) to 1
  std::optional<double> pressure_pa;    ///< peak pressure at each focus, pascals: above 0, at most 1e5
  std::optional<double> press_depth_m;  ///< a finger this deep counts as pressing, metres: above 0, at most 1
  std::optional<std::uint32_t> foci;    ///< per finger: 1 to 64
  std::optional<std::uint32_t> stride;  ///< step between consecutive foci: 1 to 1048576, coprime to foci
  std::optional<Click> click;           ///< needs press_depth_m
  /// 1 to most_stiffness_rows rows.
  std::optional<std::vector<DepthForce>> stiffness;
  /// Weights of a steady pressure and of vibrations at 30 and 150 Hz: 0 to 1, not all 0.
  std::optional<std::array<double, 3>> texture;
  std::optional<double> grain_m;  ///< the size of the texture's grains, metres: 1e-4 to 0.1

  bool clicks() const { return click && click->burst_s > 0; }

  bool operator==(const Haptics&) const = default;
};

/// The default stride. Among the strides that leave out no focus, it is the one nearest to 0.3 of the number of foci;
/// of two equally near, the larger: 3 for 10 foci.
std::uint32_t default_stride(std::uint32_t foci);

/// An error text if the stride shares a divisor with the number of foci, so that its order leaves out foci; it names
/// the usual stride. Empty if the stride is valid. A single focus works with every stride.
std::string stride_fault(std::uint32_t foci, std::uint32_t stride);

}  // namespace palpa::geometry
