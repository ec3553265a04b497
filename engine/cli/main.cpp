#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "base/output_file.hpp"
#include "base/reference.hpp"
#include "cli/commands.hpp"
#include "setup/parse.hpp"
#include "setup/program.hpp"

namespace palpa::cli {
namespace {

/// The formatter leaves two empty lines between groups, but the help should fit on one screen.
std::string tidy_help(std::string text) {
  for (std::size_t at = 0; (at = text.find("\n\n\n", at)) != std::string::npos;)
    text.erase(at, 1);
  return text;
}

void parse_and_run(int argc, const char* const* argv, const Extensions& extensions) {
  CLI::App app("Feel a 3-D model in mid-air: from depth images to a driven ultrasound array.", "palpa");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "show this help and exit");
  app.set_version_flag("--version", "palpa " PALPA_VERSION, "show the version and exit");
  app.footer(
      "Each subcommand explains itself: palpa touch --help\n"
      "Everything inside is SI; the command line also reads units: 1.5mm, 11ms, 40kHz.\n"
      "Exit codes: 0 ok, 1 failed, 2 bad usage, 3 no usable Vulkan device or display, 4 bad or missing input.");
  Program program{app, extensions, {}, nullptr};
  add_doctor(program);
  add_touch(program);
  add_run(program);
  add_export(program);
  add_link(program);
  add_calibrate(program);
  add_drive(program);
  add_field(program);
  add_scatter(program);
  add_simulate(program);
  add_decompose(program);
  add_bench(program);
  for (const auto& add : extensions.commands)
    add(program);

  try {
    setup::parse(app, argc, argv);
  } catch (const CLI::CallForHelp&) {
    write_file("-", tidy_help(app.help()));
    return;
  } catch (const CLI::CallForVersion&) {
    write_file("-", "palpa " PALPA_VERSION "\n");
    return;
  }
  setup::apply_logging(*program.common);
  allow_outside_references(program.common->allow_outside);
  setup::check(*program.common);
  program.action();
}

}  // namespace

CLI::App& add_command(Program& program, const CommandText& text) {
  CLI::App* command = program.app.add_subcommand(text.name, text.summary);
  command->set_help_flag();
  command->footer(fmt::format("Examples:\n{}", text.examples));
  return *command;
}

void finish_command(Program& program, CLI::App& command, setup::CommonOptions& common, Action action) {
  setup::add_common(command, common);
  // Set again after the command's own options, because groups are shown in the order of their first option.
  command.set_help_flag("-h,--help", "show this help and exit")->group("Common options");
  command.callback([&program, &common, action = std::move(action)] {
    program.action = action;
    program.common = &common;
  });
}

int main(int argc, const char* const* argv, const Extensions& extensions) {
  return setup::run_program([&] { parse_and_run(argc, argv, extensions); });
}

}  // namespace palpa::cli
