// palpa-viewer: shows what palpa computes, in a window or without one.
#include <dlfcn.h>

#include "driver/links.hpp"
#include "driver/sources.hpp"
#include "setup/process/program.hpp"
#include "viewer/run/command.hpp"
#include "viewer/run/run.hpp"
#include "viewer/run/study_line.hpp"
#include "viewer/run/touch_line.hpp"

namespace palpa::viewer {
namespace {

#ifdef PALPA_ADDRESS_SANITIZER
// The loader unloads lavapipe at teardown; leak reports would then name an unknown module that no suppression can
// match.
[[maybe_unused]] void* const keep_driver = dlopen("libvulkan_lvp.so", RTLD_LAZY | RTLD_NODELETE);
#endif

void parse_and_run(int argc, char** argv) {
  const LiveSession::Kinds kinds{.sources = driver::camera_sources(), .links = driver::links()};
  if (asks_for_study(argc, argv)) {
    if (const std::optional<setup::StudyRunOptions> study = read_study_line(argc, argv)) run_study(*study, kinds);
    return;
  }
  if (asks_for_touches(argc, argv)) {
    if (const std::optional<TouchLine> line = read_touch_line(argc, argv))
      run_by_touch(*line, kinds, line->options.headless ? run_scripted : run_window);
    return;
  }
  const std::optional<ViewerOptions> options = read_line(argc, argv);
  if (!options) return;
  if (options->headless) {
    run_without_window(*options, kinds);
  } else {
    run_window(*options, kinds, nullptr);
  }
}

}  // namespace
}  // namespace palpa::viewer

int main(int argc, char** argv) {
  return palpa::setup::run_program([&] { palpa::viewer::parse_and_run(argc, argv); });
}
