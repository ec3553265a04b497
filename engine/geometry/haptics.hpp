// How an object feels, as its author defined it in the model.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace palpa::geometry {

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

  bool operator==(const Haptics&) const = default;
};

/// The default stride. Among the strides that leave out no focus, it is the one nearest to 0.3 of the number of foci;
/// of two equally near, the larger: 3 for 10 foci.
std::uint32_t usual_stride(std::uint32_t foci);

/// An error text if the stride shares a divisor with the number of foci, so that its order leaves out foci; it names
/// the usual stride. Empty if the stride is valid. A single focus works with every stride.
std::string stride_fault(std::uint32_t foci, std::uint32_t stride);

}  // namespace palpa::geometry
