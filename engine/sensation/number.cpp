#include "sensation/number.hpp"

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

}  // namespace palpa::sensation
