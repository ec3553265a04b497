// A sweep's plan: a TOML file that names a command of palpa, its options, and which of them vary (docs/files.md). A
// case is one combination of the varied values. It is numbered in the plan's order, in which the last axis varies
// fastest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/toml.hpp"
#include "setup/option_table.hpp"

namespace palpa::sweep {

/// An option with a value of the plan.
struct Setting {
  std::string option;               ///< "--delta"
  std::vector<std::string> values;  ///< as on a command line; none for a flag, several for an option given repeatedly
  bool given = true;                ///< false for a flag with the value false: the case does not have it
  /// For tables: the value as the plan has it. Several values are separated by spaces.
  std::string shown() const;
  bool operator==(const Setting&) const = default;
};

/// Values of which each case has one. A value sets one option, or several together.
struct Axis {
  std::string key;                   ///< in the plan
  std::vector<std::string> options;  ///< of all its values, in the plan's order
  std::vector<std::vector<Setting>> choices;
};

/// The most cases of a plan. More would only be a mistake in it: a list of a million identifiers takes a minute.
inline constexpr std::uint64_t most_cases = 1'000'000;

struct Plan {
  std::string file, folder;          ///< files in a plan are relative to the folder
  std::string text;                  ///< its bytes
  std::string command;               ///< "touch", "drive", "field" or "simulate"
  std::vector<std::string> results;  ///< paths into the command's JSON (results.hpp), never empty
  bool results_given = false;        ///< the plan has them; otherwise they are the command's usual ones
  bool keep_everything = false;      ///< each case's line has all of the command's JSON
  std::vector<Setting> fixed;
  std::vector<Axis> axes;

  std::uint64_t count() const;
  /// The settings of a case: the fixed ones and one choice of each axis. `index` is below count().
  std::vector<Setting> settings(std::uint64_t index) const;
  /// The options that vary, in the order of the axes: the columns of tables.
  std::vector<std::string> varied() const;
};

/// Reads and checks a plan. Every value is read as its option reads it on a command line; whether options fit together
/// is seen when a case is computed. Throws bad_input naming file and line: an unknown key or option, an option that
/// belongs to the command line of the sweep itself, an invalid value, an option that is set twice, more than most_cases
/// cases (with the number of values of each axis). Reads no file other than the plan.
Plan load_plan(const std::string& file);
/// The same from a text; `file` need not exist.
Plan parse_plan(std::string text, const std::string& file);

/// The options of a case, for setup::read_given.
setup::Given given_by(const std::vector<Setting>& settings);

}  // namespace palpa::sweep
