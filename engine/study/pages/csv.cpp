#include "study/pages/csv.hpp"

#include <fmt/core.h>

#include "base/text.hpp"

namespace palpa::study {

std::string number_cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.10g}", *value) : std::string();
}

std::string name_cell(const std::string& name) {
  return csv_cell(printable(name));
}

}  // namespace palpa::study
