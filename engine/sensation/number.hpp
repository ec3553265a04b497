// The numbers of a pattern that parameters change: a constant, a parameter, or a formula.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace palpa::sensation {

struct Number {
  enum class Kind : std::uint8_t { constant, parameter, add, subtract, multiply, divide, negate };
  struct Node {
    Kind kind = Kind::constant;
    double value = 0;            ///< of a constant
    std::uint32_t a = 0, b = 0;  ///< operands, which stand before it; of a parameter, `a` is its number
  };
  std::vector<Node> nodes;  ///< the last one is the result; none: 0

  static Number of(double value) { return {{{Kind::constant, value, 0, 0}}}; }
  /// With the value of each parameter. IEEE arithmetic: a division by zero gives infinity or NaN.
  double at(std::span<const double> parameters) const;
};

}  // namespace palpa::sensation
