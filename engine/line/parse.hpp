// Parses the command line and reports errors in palpa's own words.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace palpa::line {

/// The innermost subcommand on the line that was parsed; `app`, the program, if the line has none.
CLI::App& chosen_command(CLI::App& app);
/// "touch", or "study analyse" for a subcommand of a group.
std::string command_name(const CLI::App& command);

/// "unknown subcommand 'tuoch': did you mean touch?", without the question if no subcommand of `app` is near.
std::string unknown_subcommand(const CLI::App& app, const std::string& word);

/// Reads a line with `app`, the program. Throws bad_usage with one line that names the option or the word, the valid
/// values, and the --help with more information. Also throws the parser's own CLI::CallForHelp and CLI::CallForVersion.
void parse(CLI::App& app, int argc, const char* const* argv);

}  // namespace palpa::line
