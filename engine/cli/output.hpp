// What the subcommands' outputs have in common.
#pragma once

#include <string>

namespace palpa::cli {

/// Throws bad_usage where more than one of these files is "-": their texts would run into each other.
void refuse_two_on_stdout(const std::string& json, const std::string& csv);

}  // namespace palpa::cli
