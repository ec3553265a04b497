// Options of a command that depend on each other. The parser refuses lines on which they do not go together.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "line/option_table.hpp"

namespace palpa::line {

/// Without `other`, these options have no effect: "--slot goes with --touch". All must have been added.
void need(CLI::App& app, std::span<const std::string> options, const std::string& other);
void need(CLI::App& app, std::initializer_list<std::string> options, const std::string& other);
/// A line with `option` counts as one with the flag `other`, too. A line with both is refused: `option` is another kind
/// of `other`.
void imply(CLI::App& app, const std::string& option, const std::string& other);
/// Beside `option`, the others have no effect or another meaning: "--linear and --crest exclude each other".
void exclude(CLI::App& app, const std::string& option, std::initializer_list<std::string> others);

/// The options under these headings.
std::vector<std::string> under(const CLI::App& app, std::initializer_list<std::string_view> headings);

/// What is wrong with options that are given together; empty if nothing is. For values that come from elsewhere than a
/// line that parse() reads.
std::string misfit(const CLI::App& app, const Given& given);

}  // namespace palpa::line
