#include "cli/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "line/completion.hpp"
#include "line/help.hpp"
#include "line/option_table.hpp"
#include "line/parse.hpp"
#include "line/values.hpp"

namespace palpa::cli {
namespace {

using line::HelpLength;

constexpr const char* summary = "feel a 3-D model in mid-air, from depth images to a driven ultrasound array";

std::vector<const CLI::App*> inside(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// All subcommands that do something; those of a group in its place.
std::vector<const CLI::App*> commands_of(const Program& program) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : inside(program.app)) {
    const std::vector<const CLI::App*> own = inside(*command);
    if (own.empty()) commands.push_back(command);
    commands.insert(commands.end(), own.begin(), own.end());
  }
  return commands;
}

std::string group_page(const CLI::App& group) {
  const std::string& name = group.get_name();
  std::string page = fmt::format("palpa {0}: {1}\n\nUsage: palpa {0} SUBCOMMAND [OPTION ...]\n\nSubcommands:\n", name,
                                 group.get_description());
  for (const CLI::App* command : inside(group))
    page += line::help_row(command->get_name(), command->get_description());
  return page + fmt::format("\nMore help: palpa help {} {}\n", name, inside(group).front()->get_name());
}

constexpr const char* first_examples =
    "  palpa touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm\n"
    "  palpa run --scene assets/cube.glb";

constexpr const char* more_help =
    "\n"
    "More help:\n"
    "  palpa help touch          what people use of touch, with examples; the same as palpa touch --help\n"
    "  palpa help touch all      every option of touch; the same as palpa touch --help all\n"
    "  palpa help all            options of all subcommands, units, exit codes, words\n"
    "  palpa help bash           completes command lines in bash; palpa help zsh and palpa help fish, too\n"
    "  palpa --version           the version, the build and its libraries\n";

constexpr const char* last_lines =
    "Units:\n"
    "  A number without a unit is in SI units: metres, seconds, hertz, pascals. You can give a unit:\n"
    "  1.5mm, 11ms, 40kHz, 343m/s, 8kPa.\n"
    "\n"
    "Exit codes:\n"
    "  0 done, 1 failed, 2 wrong usage, 3 no usable Vulkan device or display, 4 bad or missing input\n"
    "\n"
    "Words:\n"
    "  docs/glossary.md explains slot, dwell, stride, shell, contacts, finger, focus, drive, layout and\n"
    "  link.\n";

/// The options that every command has.
std::vector<line::OptionInfo> common_options() {
  setup::CommonOptions options;
  CLI::App app;
  setup::add_common(app, options);
  setup::add_allow_outside(line::Group(app, "Common options"), options);
  return line::option_table(app);
}

line::HelpText text_of(const Program& program, const CLI::App& command) {
  const CommandText& text = program.texts.at(line::command_name(command));
  return {.name = "palpa " + line::command_name(command),
          .arguments = text.arguments,
          .summary = text.summary,
          .usual = text.usual,
          .examples = text.examples,
          .notes = text.notes,
          .common = common_options(),
          .common_page = "palpa help all"};
}

/// `palpa help bash`, `zsh` and `fish`; empty for other words.
std::optional<std::string> completion_asked(const Program& program, const std::vector<std::string>& words) {
  const std::optional<line::Shell> shell = words.size() == 1 ? line::shell_of(words.front()) : std::nullopt;
  if (!shell) return std::nullopt;
  std::vector<line::CompletedCommand> commands;
  for (const CLI::App* command : commands_of(program))
    commands.push_back({text_of(program, *command), line::option_table(*command)});
  return line::completion(*shell, "palpa", commands);
}

/// The page of the whole program: its subcommands; with all, also what they share.
std::string overview(const Program& program, HelpLength length) {
  std::string page = fmt::format("palpa: {}\n\nUsage: palpa SUBCOMMAND [OPTION ...]\n\nSubcommands:\n", summary);
  for (const CLI::App* command : commands_of(program))
    page += line::help_row(line::command_name(*command), command->get_description());
  page += "\n";
  page += fmt::format("Examples:\n{}\n{}", first_examples, more_help);
  if (length == HelpLength::usual) return page;
  page +=
      "\nCommon options (--gpu and --validation of subcommands that use a GPU, --allow-outside of those that\n"
      "read scenes or recordings):\n";
  return page + line::help_rows(common_options()) + "\n" + last_lines;
}

/// The page of the program or of a subcommand. That of a group lists its subcommands.
std::string page_of(const Program& program, const CLI::App& command, HelpLength length) {
  if (&command == &program.app) return overview(program, length);
  if (!inside(command).empty()) return group_page(command);
  return line::help_page(command, text_of(program, command), length);
}

}  // namespace

std::optional<std::string> help_asked(const Program& program, int argc, const char* const* argv) {
  if (argc < 2) return overview(program, HelpLength::usual);
  if (std::string_view(argv[1]) != "help") return std::nullopt;
  std::vector<std::string> words(argv + 2, argv + argc);
  const bool all = !words.empty() && words.back() == "all";
  if (all) words.pop_back();
  const HelpLength length = all ? HelpLength::all : HelpLength::usual;
  if (!all) {
    if (std::optional<std::string> script = completion_asked(program, words)) return script;
  }
  const CLI::App* found = &program.app;
  std::istringstream names(fmt::format("{}", fmt::join(words, " ")));
  for (std::string name; names >> name;) {
    const std::vector<const CLI::App*> known = inside(*found);
    const auto next = std::ranges::find(known, name, [](const CLI::App* command) { return command->get_name(); });
    if (next == known.end()) {
      const std::string fault = known.empty() ? "give palpa help one subcommand, and the word all or nothing"
                                              : line::unknown_subcommand(*found, name);
      throw bad_usage(fmt::format("{}{} see palpa --help", fault, fault.ends_with('?') ? "" : ";"));
    }
    found = *next;
  }
  return page_of(program, *found, length);
}

std::string help_of_line(const Program& program, int argc, const char* const* argv) {
  return page_of(program, line::chosen_command(program.app), line::help_length(argc, argv));
}

}  // namespace palpa::cli
