// palpa-viewer: shows what palpa computes, in a window or without one.
#include <dlfcn.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "base/output_file.hpp"
#include "base/reference.hpp"
#include "driver/guard/board_link.hpp"
#include "driver/sources.hpp"
#include "setup/parse.hpp"
#include "setup/program.hpp"
#include "viewer/app/settings.hpp"
#include "viewer/app/viewer_options.hpp"
#include "viewer/run/run.hpp"

namespace palpa::viewer {
namespace {

#ifdef __SANITIZE_ADDRESS__
// The loader unloads lavapipe at teardown; leak reports would then name an unknown module that no suppression can
// match.
[[maybe_unused]] void* const keep_driver = dlopen("libvulkan_lvp.so", RTLD_LAZY | RTLD_NODELETE);
#endif

void parse_and_run(int argc, char** argv) {
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
    return;
  } catch (const CLI::CallForVersion&) {
    write_file("-", "palpa-viewer " PALPA_VERSION "\n");
    return;
  }
  setup::apply_logging(options.common);
  allow_outside_references(options.common.allow_outside);
  options.given = setup::given_on(app);
  check(options);
  if (const auto settings = settings_file(); options.headless && settings) warn_of_settings(*settings);
  const LiveSession::Kinds kinds{.sources = driver::camera_sources(), .links = driver::board_links()};
  if (!options.headless) {
    run_window(options, kinds);
  } else if (options.is_live() || !options.interact.empty()) {
    run_scripted(options, kinds);
  } else {
    run_headless(options);
  }
}

}  // namespace
}  // namespace palpa::viewer

int main(int argc, char** argv) {
  return palpa::setup::run_program([&] { palpa::viewer::parse_and_run(argc, argv); });
}
