// The help pages of palpa's programs, in two lengths. They are written from the table of options (option_table.hpp), so
// they look the same whatever the version of the command line's parser.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "line/option_table.hpp"

namespace palpa::line {

/// No line of a page is longer, in columns. Examples are printed as they are, so they must keep to it.
inline constexpr std::size_t help_columns = 100;
/// The most lines of a page of usual length.
inline constexpr std::size_t most_usual_lines = 40;

enum class HelpLength {
  usual,  ///< the options that people use
  all,    ///< every option
};

/// The parts of a page that are not in the table of options.
struct HelpText {
  std::string name;       ///< "palpa touch"
  std::string arguments;  ///< placeholders of the words that follow the name, "BOARD"; usually none
  std::string summary;    ///< one line
  std::string usual;      ///< names of the options that people use, separated by spaces; empty: all of its own
  std::string examples;   ///< lines, each indented by two spaces
  std::string notes;      ///< a sentence or two below the examples; may be empty
  /// Options that this page only names, because another one describes them: "palpa help all". May be empty.
  std::vector<OptionInfo> common{};
  std::string common_page{};
};

/// The page of `app`, whose options must have been added with Groups.
std::string help_page(const CLI::App& app, const HelpText& text, HelpLength length);

/// The descriptions of these options.
std::string help_rows(const std::vector<OptionInfo>& options);

/// Lines "  name   text", the text in a column of its own.
std::string help_row(std::string_view name, std::string_view text);
/// `text` in lines of at most help_columns, each indented by this many spaces. Words longer than that are not divided.
std::string wrapped(std::string_view text, std::size_t indent);

/// The word that follows --help on a command line, or --help=; empty if there is none.
std::string word_after_help(int argc, const char* const* argv);
/// What follows --help on a command line: HelpLength::all for the word "all" (or --help=all), else usual.
HelpLength help_length(int argc, const char* const* argv);

}  // namespace palpa::line
