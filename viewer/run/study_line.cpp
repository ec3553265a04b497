#include "viewer/run/study_line.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string_view>

#include "base/files/output_file.hpp"
#include "line/help.hpp"
#include "line/values.hpp"
#include "viewer/run/command.hpp"

namespace palpa::viewer {
namespace {

bool has_word(int argc, const char* const* argv, std::string_view word) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view given = argv[i];
    if (given == word || (given.starts_with(word) && given.substr(word.size()).starts_with('='))) return true;
  }
  return false;
}

line::HelpText study_help() {
  return {.name = "palpa-viewer --study",
          .arguments = "",
          .summary = "a participant's sitting in front of an array; palpa study run starts it",
          .usual = "--study --participant --out --source --link --rig --monitor --size --override --rehearse --hold",
          .examples =
              "  palpa-viewer --study my-plan.toml --participant 1 --out my-study --source v4l2:/dev/video0 \\\n"
              "               --link openmpd:FT43NK5M --rig my-rig.toml\n",
          .notes =
              "docs/study.md explains the two windows. A sitting that was stopped is continued by the same command. "
              "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 no display, 4 bad or missing input."};
}

}  // namespace

bool asks_for_study(int argc, const char* const* argv) {
  return has_word(argc, argv, "--study");
}

std::optional<setup::StudyRunOptions> read_study_line(int argc, const char* const* argv) {
  CLI::App app("", "palpa-viewer");
  setup::StudyRunOptions options;
  const line::Group group(app, "Study");
  group.text("--study", options.plan, "PLAN", "TOML file of the study");
  setup::add_study_run_options(app, options);
  setup::add_common(app, options.common);
  const auto help = [&] { return line::help_page(app, study_help(), line::help_length(argc, argv)); };
  if (has_word(argc, argv, "--help") || has_word(argc, argv, "-h")) {
    write_file("-", help());
    return std::nullopt;
  }
  if (!parse_line(app, options.common, argc, argv, help)) return std::nullopt;
  setup::check(options);
  setup::check(options.common);
  return options;
}

}  // namespace palpa::viewer
