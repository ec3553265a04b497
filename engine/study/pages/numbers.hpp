// Numbers as they stand in the reports for people, and cells of CSV. JSON and CSV have more digits.
#pragma once

#include <optional>
#include <string>

#include "study/statistics/moments.hpp"

namespace palpa::study {

/// What stands for a value that does not exist.
inline constexpr const char* no_value = "-";

/// Three decimals.
std::string shown(double value);
std::string shown(const std::optional<double>& value);
/// "0.217 to 0.308".
std::string shown(const std::optional<Interval>& interval);
/// "p = 0.00195", with three digits.
std::string shown_p(double p);
/// "r = 0.867 (p = 0.00117)".
std::string shown(const std::optional<Correlation>& correlation);

// ---- CSV

/// Ten digits; empty without a value.
std::string number_cell(const std::optional<double>& value);
/// A name that cannot break the table: printable, and quoted if necessary.
std::string name_cell(const std::string& name);

}  // namespace palpa::study
