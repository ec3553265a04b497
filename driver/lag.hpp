// How late a further board of an array runs after the first one. Boards share the frequency of their carriers, but not
// their phase. The drivers send its phases this much earlier.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace palpa::driver {

/// Cuts ",lag=PERIODS" off the end of a link's argument. PERIODS is from 0 up to but not including 1. Throws bad_usage,
/// also if something comes after it.
std::optional<double> take_lag(std::string& argument);

/// Throws bad_usage if a lag was given for a single board.
void refuse_lag_of_one(const std::optional<double>& lag, std::size_t boards);

}  // namespace palpa::driver
