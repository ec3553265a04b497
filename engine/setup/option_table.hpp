// A command's options as a table: what a program with windows shows, so that it offers what the command line has, with
// the same names, words, ranges and help. And back: the command line that says the same.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace palpa::setup {

struct OptionInfo {
  std::string name;                ///< "--delta"
  std::string heading;             ///< under which --help lists it
  std::string type;                ///< what stands for its value, "LENGTH"; empty for a flag
  std::string help;                ///< without words and default
  std::string initial;             ///< as --help has it; empty where there is none
  std::vector<std::string> words;  ///< its values, where they are few
  bool flag = false;
};

/// Options of a Group of `app`, in the order of --help, without --help and --version.
std::vector<OptionInfo> option_table(const CLI::App& app);

/// What a line gives: each option with its values; none for a flag.
using Given = std::map<std::string, std::vector<std::string>>;

/// What was given on the line that `app` has parsed.
Given given_on(const CLI::App& app);
/// Of `given` what `table` has.
Given known_to(const std::vector<OptionInfo>& table, const Given& given);

/// Reads each of `given` into its option's target as if it stood on a line, but without one: in the order of `app`,
/// whose other options keep their targets as they are. Throws bad_usage as parse() does for values that cannot be.
void read_given(CLI::App& app, const Given& given);

/// `command` and what is given, in the table's order, as a shell reads it; "'" where it must.
std::string command_line(std::string_view command, const std::vector<OptionInfo>& table, const Given& given);

}  // namespace palpa::setup
