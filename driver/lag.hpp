// How late a further board of an array runs after the first one. Boards share the frequency of their carriers, but not
// their phase. The drivers send its phases this much earlier.
#pragma once

#include <optional>
#include <string>

namespace palpa::driver {

/// Cuts ",lag=PERIODS" off the end of a link's argument. PERIODS is from 0 up to but not including 1. Throws bad_usage.
std::optional<double> take_lag(std::string& argument);

}  // namespace palpa::driver
