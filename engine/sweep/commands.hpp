// The commands whose cases a sweep computes: which options a plan may set, and which results are kept by default.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "setup/option_table.hpp"
#include "setup/options.hpp"
#include "setup/tasks/lines.hpp"
#include "sweep/plan.hpp"
#include "sweep/results.hpp"

namespace palpa::sweep {

struct Command {
  std::string name;
  std::vector<setup::OptionInfo> options;  ///< that a plan may set, in the order of the help
  std::vector<std::string> results;        ///< paths (results.hpp) of a plan without `results`
  std::vector<Structure> structures;       ///< all lists and objects of its output
};

std::vector<std::string> command_names();
/// `name` is one of these names.
const Command& command_of(const std::string& name);

/// Reads a value as its option does. Throws bad_usage.
void check_value(const Command& command, const Setting& setting);

/// The part of an option's value that names a file that is read: the whole value, or the rig of a --spread. Empty if
/// the value names no file, for example if it is a built-in layout.
std::string file_in(const setup::OptionInfo& option, const std::string& value);

/// The options of a case, as its command reads them.
using Line = std::variant<setup::TouchLine, setup::DriveLine, setup::FieldLine, setup::SimulateLine>;
/// Throws bad_usage for values that an option refuses.
std::unique_ptr<Line> read_line(const Command& command, const setup::Given& given);
/// Throws bad_usage for options that do not fit together. Reads no file.
void check_line(Line& line);

}  // namespace palpa::sweep
