#include "viewer/run/command.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "base/files/output_file.hpp"
#include "base/files/reference.hpp"
#include "base/version.hpp"
#include "line/completion.hpp"
#include "line/help.hpp"
#include "line/option_table.hpp"
#include "line/parse.hpp"
#include "viewer/options/preferences.hpp"
#include "viewer/run/run.hpp"

namespace palpa::viewer {

namespace {

line::HelpText help_text() {
  return {
      .name = "palpa-viewer",
      .arguments = "",
      .summary = "looks at a touch: object, skin, contacts, foci and array, in a window or as a picture",
      .usual = "--scene --points --skin --penetration --layout --source --link --headless --screenshot --size",
      .examples =
          "  palpa-viewer --scene assets/cube.glb --points assets/finger.ply --penetration 3mm\n"
          "  palpa-viewer --scene assets/cube.glb --points assets/finger.ply --penetration 3mm \\\n"
          "               --headless --screenshot touch.png",
      .notes =
          "With --source, it shows a live run, as palpa run does without a picture. In the window, H shows what mouse "
          "and keys do, and O switches the array off. docs/viewer.md has the rest. palpa-viewer --by-touch --help: the "
          "window of a calibration. Exit codes: 0 done, 1 failed, 2 "
          "wrong usage, 3 no usable Vulkan device or display, 4 bad or missing input."};
}

/// `--help`; `--help bash`, `zsh` and `fish` complete command lines.
std::string page_of(const CLI::App& app, int argc, const char* const* argv) {
  if (const auto shell = line::shell_of(line::word_after_help(argc, argv)))
    return line::completion(*shell, "palpa-viewer", {{help_text(), line::option_table(app)}});
  return line::help_page(app, help_text(), line::help_length(argc, argv));
}

}  // namespace

bool parse_line(CLI::App& app, const setup::CommonOptions& common, int argc, const char* const* argv,
                const std::function<std::string()>& help) {
  app.set_help_flag("-h,--help", "show this help and exit");
  app.set_version_flag("--version", version(), "show the version and exit");
  try {
    line::parse(app, argc, argv);
  } catch (const CLI::CallForHelp&) {
    write_file("-", help());
    return false;
  } catch (const CLI::CallForVersion&) {
    write_file("-", about_program("palpa-viewer"));
    return false;
  }
  setup::apply_logging(common);
  return true;
}

std::optional<ViewerOptions> read_line(int argc, const char* const* argv) {
  CLI::App app("", "palpa-viewer");
  ViewerOptions options;
  add_options(app, options);
  setup::add_common(app, options.common);
  if (!parse_line(app, options.common, argc, argv, [&] { return page_of(app, argc, argv); })) return std::nullopt;
  allow_outside_references(options.common.allow_outside);
  options.given = line::given_on(app);
  check(options);
  return options;
}

void run_without_window(const ViewerOptions& options, const LiveSession::Kinds& kinds) {
  if (const auto settings = preferences_file()) warn_of_preferences(*settings);
  if (options.is_live() || !options.interact.empty()) {
    run_scripted(options, kinds, nullptr);
  } else {
    run_headless(options);
  }
}

}  // namespace palpa::viewer
