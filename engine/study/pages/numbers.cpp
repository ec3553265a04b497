#include "study/pages/numbers.hpp"

#include <fmt/core.h>

#include "base/text.hpp"

namespace palpa::study {

std::string shown(double value) {
  // 0.6525 is a little less as a double, but people round it up.
  const std::string text = fmt::format("{:.3f}", value + (value < 0 ? -1e-9 : 1e-9));
  return text == "-0.000" ? "0.000" : text;
}

std::string shown(const std::optional<double>& value) {
  return value ? shown(*value) : no_value;
}

std::string shown(const std::optional<Interval>& interval) {
  return interval ? fmt::format("{} to {}", shown(interval->low), shown(interval->high)) : no_value;
}

std::string shown_p(double p) {
  return fmt::format("p = {:.3g}", p);
}

std::string shown(const std::optional<Correlation>& correlation) {
  return correlation ? fmt::format("r = {} ({})", shown(correlation->r), shown_p(correlation->p)) : no_value;
}

std::string number_cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.10g}", *value) : std::string();
}

std::string name_cell(const std::string& name) {
  return csv_cell(printable(name));
}

}  // namespace palpa::study
