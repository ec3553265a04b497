// A command's options as a table. A graphical program can use it to offer the options of the command line with the same
// names, words, ranges and help. The reverse is also available: the equivalent command line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace palpa::line {

struct OptionInfo {
  std::string name;                ///< "--delta"
  std::string heading;             ///< the heading of its group in --help
  std::string type;                ///< placeholder of its value, e.g. "LENGTH"; empty for a flag
  std::string help;                ///< help text without words and default
  std::string initial;             ///< default as shown in --help; empty if there is none
  std::vector<std::string> words;  ///< its values, if there are only a few
  bool flag = false;
};

/// The options in any Group of `app`, in the order of --help, without --help and --version.
std::vector<OptionInfo> option_table(const CLI::App& app);

/// The options given on a command line, with their values; a flag has none.
using Given = std::map<std::string, std::vector<std::string>>;
/// Gives the option the text of a text field: its only value, or none if the text is empty. nullopt takes it away.
void give(Given& given, const std::string& option, const std::optional<std::string>& text);

/// The options given on the line that `app` has parsed.
Given given_on(const CLI::App& app);
/// The options of `given` that are in `table`.
Given known_to(const std::vector<OptionInfo>& table, const Given& given);

/// Reads each of `given` into its option's target, as if it were on a command line, in the order of `app`. The targets
/// of other options stay unchanged. Throws bad_usage for invalid values, as parse() does.
void read_given(CLI::App& app, const Given& given);

/// In single quotes, for a shell.
std::string shell_quoted(const std::string& text);
/// The given options as words of a command line.
std::vector<std::string> words_of(const Given& given);
/// `command` and the given options, in the table's order, as text for a shell; quoted with "'" if necessary.
std::string command_line(std::string_view command, const std::vector<OptionInfo>& table, const Given& given);

}  // namespace palpa::line
