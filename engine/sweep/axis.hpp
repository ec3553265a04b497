// The values of a plan's options.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/toml.hpp"
#include "setup/option_table.hpp"
#include "sweep/plan.hpp"

namespace palpa::sweep {

/// What is wrong with a value of a plan; the caller knows file and line.
struct ValueFault {
  std::string text;
};

/// The option of `table` that a plan's key names. Throws ValueFault with the nearest option for an unknown one.
const setup::OptionInfo& option_of(const std::vector<setup::OptionInfo>& table, const std::string& key);

/// One value of an option: a text, a number or true; a list for an option that a line may have several times, or with
/// several values. Throws ValueFault.
Setting setting_of(const setup::OptionInfo& option, const TomlValue& value);

/// How many values axis_of() would make of it, without making them; at least 1, also for a value that it refuses.
std::uint64_t count_of(const TomlValue& value);

/// The axis of a key of [vary]: a list of values of the option `key`; { from, to, count } for equal steps; or a list of
/// tables, whose keys are options, for values that belong together. Throws ValueFault.
Axis axis_of(const std::vector<setup::OptionInfo>& table, const std::string& key, const TomlValue& value);

}  // namespace palpa::sweep
