// palpa-viewer: looks at what palpa computes, in a window or without one.
#include <dlfcn.h>
#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "base/log.hpp"
#include "cli/output.hpp"
#include "viewer/options.hpp"
#include "viewer/run.hpp"

namespace palpa::viewer {
namespace {

#ifdef __SANITIZE_ADDRESS__
// The loader unloads lavapipe at teardown; leak reports would then name an unknown module that no suppression can
// match.
[[maybe_unused]] void* const keep_driver = dlopen("libvulkan_lvp.so", RTLD_LAZY | RTLD_NODELETE);
#endif

/// Names from files and arguments may hold anything; an error stays one line.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '.'))
    text.pop_back();
  return text;
}

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
      "In the window: left-drag orbits, the wheel zooms, middle- or shift-drag pans; 1, 3 and 7 look from the front, "
      "the\n"
      "right and the top, 5 switches between perspective and parallel projection, F frames everything, space stops "
      "the\n"
      "running focus, Escape or q quits.\n"
      "Exit codes: 0 ok, 1 failed, 2 bad usage, 3 no usable Vulkan device or display, 4 bad or missing input.");
  Options options;
  add_options(app, options);
  cli::add_common(app, options.common);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    cli::write_output("-", app.help());
    return;
  } catch (const CLI::CallForVersion&) {
    cli::write_output("-", "palpa-viewer " PALPA_VERSION "\n");
    return;
  } catch (const CLI::ParseError& error) {
    std::string line = one_line(error.what());
    if (line.starts_with("A ") || line.starts_with("The ")) line[0] = static_cast<char>(line[0] - 'A' + 'a');
    throw bad_usage(fmt::format("{}; see palpa-viewer --help", line));
  }
  cli::apply_logging(options.common);
  check(options);
  if (options.headless) {
    Show show(options);
    run_headless(options, show);
  } else {
    run_window(options);
  }
  if (const std::uint64_t errors = gpu::validation_errors()) {
    throw failure(fmt::format("Vulkan validation reported {} error{}", errors, errors == 1 ? "" : "s"));
  }
}

Exit report(Exit code, const std::string& line) {
  log::error(one_line(line));
  return code;
}

}  // namespace
}  // namespace palpa::viewer

int main(int argc, char** argv) {
  using palpa::Exit;
  using palpa::viewer::report;
  std::signal(SIGPIPE, SIG_IGN);
  Exit code = Exit::ok;
  try {
    palpa::viewer::parse_and_run(argc, argv);
  } catch (const palpa::Error& error) {
    code = report(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    code = report(Exit::failed, "out of memory");
  } catch (const std::exception& error) {
    code = report(Exit::failed, error.what());
  }
  return static_cast<int>(code);
}
