#include "sensation/pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpa::sensation {

std::optional<std::uint32_t> Pattern::parameter(std::string_view wanted) const {
  const auto found = std::ranges::find(parameters, wanted, &Parameter::name);
  if (found == parameters.end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - parameters.begin());
}

Values values_of(const Pattern& pattern, const std::map<std::string, double>& given) {
  Values values;
  for (const Parameter& parameter : pattern.parameters) {
    values.value.push_back(std::clamp(parameter.usual, parameter.low, parameter.high));
    values.known.push_back(parameter.defined);
  }
  for (const auto& [name, value] : given) {
    if (!std::isfinite(value)) throw bad_usage(fmt::format("parameter {}: {} is not a finite number", name, value));
    const std::optional<std::uint32_t> number = pattern.parameter(name);
    if (!number) continue;
    const Parameter& parameter = pattern.parameters[*number];
    values.value[*number] = std::clamp(value, parameter.low, parameter.high);
    values.known[*number] = true;
  }
  return values;
}

double fastest_hz(const Pattern& pattern, const Values& values) {
  double fastest = 0;
  for (const Keyframe& keyframe : pattern.keyframes) {
    if (!keyframe.brush) continue;
    const Brush& brush = keyframe.brush->value;
    for (const Number* hz : {&brush.stm_hz, &brush.am_hz}) {
      const double value = std::abs(hz->at(values.value));
      if (std::isfinite(value)) fastest = std::max(fastest, value);
    }
  }
  return fastest;
}

}  // namespace palpa::sensation
