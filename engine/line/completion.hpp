// The completion of a program's command lines for shells. It is made from the tables of options, as the help pages are.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "line/help.hpp"
#include "line/option_table.hpp"

namespace palpa::line {

/// One command of a program. A program without subcommands is one command with the program's name.
struct CompletedCommand {
  HelpText text;                    ///< its name includes the program's: "palpa touch"
  std::vector<OptionInfo> options;  ///< all of them
};

enum class Shell { bash, zsh, fish };
std::optional<Shell> shell_of(std::string_view word);

/// A script with which the shell completes the program's subcommands, options, and those values that are words or
/// files.
std::string completion(Shell shell, const std::string& program, const std::vector<CompletedCommand>& commands);

}  // namespace palpa::line
