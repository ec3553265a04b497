// The manual of a program as text for man, and the completion of its command lines for shells. Both are made from the
// tables of options, as its help pages are.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "setup/help.hpp"
#include "setup/option_table.hpp"

namespace palpa::setup {

/// One command of a program. A program without subcommands is one command with the program's name.
struct ManualCommand {
  HelpText text;                    ///< its name includes the program's: "palpa touch"
  std::vector<OptionInfo> options;  ///< all of them
};

enum class Shell { bash, zsh, fish };
std::optional<Shell> shell_of(std::string_view word);

/// The page of a command in man's macros, section 1.
std::string man_page(const ManualCommand& command);
/// The page of a program with subcommands, which has pages of its own for each.
std::string man_page(const std::string& program, const std::string& summary, const std::string& examples,
                     const std::vector<ManualCommand>& commands);

/// A script with which the shell completes the program's subcommands, options, and those values that are words or
/// files.
std::string completion(Shell shell, const std::string& program, const std::vector<ManualCommand>& commands);

}  // namespace palpa::setup
