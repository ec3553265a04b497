#include "viewer/run/command.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "base/output_file.hpp"
#include "base/reference.hpp"
#include "setup/parse.hpp"
#include "viewer/app/settings.hpp"
#include "viewer/run/run.hpp"

namespace palpa::viewer {

std::optional<ViewerOptions> read_line(int argc, const char* const* argv) {
  CLI::App app("Looks at a touch: object, skin, contacts, foci and array, in a window or as a picture.",
               "palpa-viewer");
  app.get_formatter()->column_width(34);
  app.set_help_flag("-h,--help", "show this help and exit");
  app.set_version_flag("--version", "palpa-viewer " PALPA_VERSION, "show the version and exit");
  app.footer(
      "Examples:\n"
      "  palpa-viewer --scene assets/cube.glb --points assets/finger.ply --skin assets/finger.ply --penetration 3mm\n"
      "  palpa-viewer --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout paper \\\n"
      "               --headless --screenshot touch.png\n"
      "  palpa-viewer --scene assets/cube.glb --source synthetic --link foci:udp:127.0.0.1:9000\n"
      "In the window H shows what mouse and keys do, O switches the array off; docs/viewer.md tells the rest.\n"
      "Exit codes: 0 ok, 1 failed, 2 bad usage, 3 no usable Vulkan device or display, 4 bad or missing input.");
  ViewerOptions options;
  add_options(app, options);
  setup::add_common(app, options.common);
  try {
    setup::parse(app, argc, argv);
  } catch (const CLI::CallForHelp&) {
    write_file("-", app.help());
    return std::nullopt;
  } catch (const CLI::CallForVersion&) {
    write_file("-", "palpa-viewer " PALPA_VERSION "\n");
    return std::nullopt;
  }
  setup::apply_logging(options.common);
  allow_outside_references(options.common.allow_outside);
  options.given = setup::given_on(app);
  check(options);
  return options;
}

void run_without_window(const ViewerOptions& options, const LiveSession::Kinds& kinds) {
  if (const auto settings = settings_file()) warn_of_settings(*settings);
  if (options.is_live() || !options.interact.empty()) {
    run_scripted(options, kinds);
  } else {
    run_headless(options);
  }
}

}  // namespace palpa::viewer
