// `palpa`, `palpa help ...` and `--help`: which page is printed.
#pragma once

#include <optional>
#include <string>

#include "cli/command.hpp"

namespace palpa::cli {

/// The page that a line asks for before any option is read: `palpa` alone, and `palpa help [SUBCOMMAND] [all]`. Empty
/// for all other lines. "study analyse" may be one word or two. Throws bad_usage for a subcommand that does not exist.
std::optional<std::string> help_asked(const Program& program, int argc, const char* const* argv);
/// The page for a line with --help, after it has been read.
std::string help_of_line(const Program& program, int argc, const char* const* argv);

}  // namespace palpa::cli
