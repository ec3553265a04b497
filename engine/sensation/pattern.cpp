#include "sensation/pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpa::sensation {
namespace {

double value_of(const Number& number, std::uint32_t index, std::span<const double> parameters) {
  const Number::Node& node = number.nodes[index];
  const auto a = [&] { return value_of(number, node.a, parameters); };
  const auto b = [&] { return value_of(number, node.b, parameters); };
  switch (node.kind) {
    case Number::Kind::constant:
      return node.value;
    case Number::Kind::parameter:
      return parameters[node.a];
    case Number::Kind::add:
      return a() + b();
    case Number::Kind::subtract:
      return a() - b();
    case Number::Kind::multiply:
      return a() * b();
    case Number::Kind::divide:
      return a() / b();
    case Number::Kind::negate:
      return -a();
  }
  return 0;
}

}  // namespace

double Number::at(std::span<const double> parameters) const {
  return nodes.empty() ? 0 : value_of(*this, static_cast<std::uint32_t>(nodes.size() - 1), parameters);
}

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
