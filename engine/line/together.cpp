#include "line/together.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <algorithm>

#include "base/error.hpp"

namespace palpa::line {
namespace {

std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? std::string() : "--" + option.get_lnames().front();
}

std::string both(const std::string& one, const std::string& other) {
  return fmt::format("{} and {} exclude each other: give one of them", one, other);
}

/// The last of the given options that it excludes: options are added after those that they imply, which nobody may have
/// given.
std::string last_excluded(const CLI::App& app, const CLI::Option& option, const Given& given) {
  std::string last;
  for (const CLI::Option* other : app.get_options()) {
    const bool excludes = option.get_excludes().contains(const_cast<CLI::Option*>(other));
    if (excludes && given.contains(name_of(*other))) last = name_of(*other);
  }
  return last;
}

}  // namespace

void need(CLI::App& app, std::span<const std::string> options, const std::string& other) {
  for (const std::string& option : options)
    app.get_option(option)->needs(app.get_option(other));
}

void need(CLI::App& app, std::initializer_list<std::string> options, const std::string& other) {
  need(app, std::span(options.begin(), options.size()), other);
}

void imply(CLI::App& app, const std::string& option, const std::string& other) {
  CLI::Option* const implied = app.get_option(other);
  app.get_option(option)->each([option, other, implied, added = false](const std::string&) mutable {
    if (implied->count() == 0) {
      implied->add_result("true");
      added = true;
    } else if (!added) {
      throw CLI::ParseError(both(other, option), CLI::ExitCodes::ExcludesError);
    }
  });
}

void exclude(CLI::App& app, const std::string& option, std::initializer_list<std::string> others) {
  for (const std::string& other : others)
    app.get_option(option)->excludes(app.get_option(other));
}

std::vector<std::string> under(const CLI::App& app, std::initializer_list<std::string_view> headings) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (std::ranges::find(headings, option->get_group()) != headings.end()) names.push_back(name_of(*option));
  }
  return names;
}

std::string misfit(const CLI::App& app, const Given& given) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = name_of(*option);
    if (!given.contains(name)) continue;
    for (const CLI::Option* other : option->get_needs()) {
      if (!given.contains(name_of(*other))) return fmt::format("{} goes with {}", name, name_of(*other));
    }
    const std::string excluded = last_excluded(app, *option, given);
    if (!excluded.empty()) return both(name, excluded);
  }
  return {};
}

}  // namespace palpa::line
