#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/reference.hpp"
#include "base/version.hpp"
#include "cli/commands.hpp"
#include "cli/help.hpp"
#include "line/parse.hpp"
#include "setup/process/program.hpp"

namespace palpa::cli {
namespace {

void parse_and_run(int argc, const char* const* argv, const Extensions& extensions) {
  if (argc > 1 && std::string_view(argv[1]) == "sweep")
    throw bad_usage("palpa sweep is now a Python program: python3 -m palpa.sweeps PLAN; docs/sweeps.md describes it");
  CLI::App app("", "palpa");
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "show this help and exit");
  app.set_version_flag("--version", version(), "show the version and exit");
  Program program{app, extensions, {}, nullptr};
  add_doctor(program);
  add_touch(program);
  add_run(program);
  add_play(program);
  add_export(program);
  add_link(program);
  add_calibrate(program);
  add_drive(program);
  add_field(program);
  add_scatter(program);
  add_simulate(program);
  add_afferents(program);
  add_decompose(program);
  add_study(program);
  add_bench(program);
  for (const auto& add : extensions.commands)
    add(program);

  if (const std::optional<std::string> page = help_asked(program, argc, argv)) {
    write_file("-", *page);
    return;
  }
  try {
    line::parse(app, argc, argv);
  } catch (const CLI::CallForHelp&) {
    write_file("-", help_of_line(program, argc, argv));
    return;
  } catch (const CLI::CallForVersion&) {
    write_file("-", about_program("palpa"));
    return;
  }
  setup::apply_logging(*program.common);
  allow_outside_references(program.common->allow_outside);
  setup::check(*program.common);
  program.action();
}

}  // namespace

void add_group(Program& program, const char* name, const char* summary) {
  program.app.add_subcommand(name, summary)->require_subcommand(1);
}

CLI::App& add_command(Program& program, const CommandText& text) {
  program.texts.emplace(text.name, text);
  const std::string name = text.name;
  const std::size_t space = name.find(' ');
  if (space == std::string::npos) return *program.app.add_subcommand(name, text.summary);
  return *program.app.get_subcommand(name.substr(0, space))->add_subcommand(name.substr(space + 1), text.summary);
}

void finish_command(Program& program, CLI::App& command, setup::CommonOptions& common, Action action,
                    setup::Computes computes) {
  setup::add_common(command, common, computes);
  command.callback([&program, &common, action = std::move(action)] {
    program.action = action;
    program.common = &common;
  });
}

int main(int argc, const char* const* argv, const Extensions& extensions) {
  return setup::run_program([&] { parse_and_run(argc, argv, extensions); });
}

}  // namespace palpa::cli
