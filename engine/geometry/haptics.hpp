// How an object is to be felt, as its author wrote it into the model.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace palpa::geometry {

/// Read from the `extras` of a glTF node, where modelling programs keep their custom properties (docs/scenes.md). An
/// empty optional stands for the session's value. Ranges are checked when the model is read; that foci and stride
/// have no common divisor, only where the model gives both.
struct Haptics {
  bool touchable = true;                ///< false: scenery, of which no solid is made and which need not be closed
  std::optional<double> delta_m;        ///< thickness of the shell, metres: above 0, at most 0.1
  std::optional<double> dwell_s;        ///< how long a focus lasts, seconds: 1e-6 to 10
  std::optional<double> intensity;      ///< of this object's foci: 0 (silent) to 1
  std::optional<double> pressure_pa;    ///< peak pressure at each focus, pascals: above 0, at most 1e5
  std::optional<double> press_depth_m;  ///< a finger this deep presses, metres: above 0, at most 1
  std::optional<std::uint32_t> foci;    ///< per finger: 1 to 64
  std::optional<std::uint32_t> stride;  ///< every which focus is next: 1 to 1048576, coprime to foci

  bool operator==(const Haptics&) const = default;
};

/// The stride where nobody says one: of those that leave no focus out the nearest to 0.3 of their number, and of two
/// equally near the larger: 3 of 10.
std::uint32_t usual_stride(std::uint32_t foci);

/// A stride for so many foci that leaves none out: the nearest below `stride` (modulo their number), at least 1.
std::uint32_t coprime_stride(std::uint32_t foci, std::uint32_t stride);

/// What is wrong with a stride that shares a divisor with the number of foci, so that its order leaves foci out, and
/// which stride would do; empty where nothing is. One focus goes with every stride.
std::string stride_fault(std::uint32_t foci, std::uint32_t stride);

}  // namespace palpa::geometry
