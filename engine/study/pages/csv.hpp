// Cells of the CSV that reports write.
#pragma once

#include <optional>
#include <string>

namespace palpa::study {

/// Ten digits; empty without a value.
std::string number_cell(const std::optional<double>& value);
/// A name that cannot break the table: printable, and quoted if necessary.
std::string name_cell(const std::string& name);

}  // namespace palpa::study
