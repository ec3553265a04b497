#include "study/pages/csv.hpp"

#include <fmt/core.h>

#include <cstddef>

#include "base/text.hpp"

namespace palpa::study {

std::string number_cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.10g}", *value) : std::string();
}

std::string name_cell(const std::string& name) {
  std::string safe = printable(name);
  if (safe.find_first_of(",\"") == std::string::npos) return safe;
  for (std::size_t at = safe.find('"'); at != std::string::npos; at = safe.find('"', at + 2))
    safe.insert(at, 1, '"');
  return '"' + safe + '"';
}

}  // namespace palpa::study
