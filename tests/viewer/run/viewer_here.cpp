#include "viewer_here.hpp"

#include <thread>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "base/files/reference.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "setup/options/options.hpp"
#include "support/shared_data.hpp"
#include "viewer/run/command.hpp"

namespace palpa::test {
namespace {

void draw(const std::vector<std::string>& words) {
  std::vector<const char*> line{"palpa-viewer"};
  for (const std::string& word : words)
    line.push_back(word.c_str());
  const auto options = viewer::read_line(static_cast<int>(line.size()), line.data());
  if (!options) return;
  if (!options->headless) throw failure("a window is opened by the program alone");
  setup::keep_devices();
  viewer::run_without_window(*options, {});
}

}  // namespace

Result viewer_here(const std::vector<std::string>& words) {
  Result result;
  result.exit_code = 0;
  // On a separate thread: drawing a live run permanently lowers the priority of its thread.
  std::thread([&] {
    const auto all_files = keep_register();
    try {
      draw(words);
    } catch (const Error& error) {
      result.exit_code = static_cast<int>(error.code());
      result.err = "palpa: error: " + one_line(error.what()) + "\n";
    }
  }).join();
  log::drop_warnings();
  log::set_level(log::Level::warning);
  allow_outside_references(false);
  return result;
}

Result viewer(const std::vector<std::string>& words) {
  return run_program(PALPA_VIEWER_BINARY, words, {{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
}

std::vector<std::string> cube_touch(const std::vector<std::string>& more, const std::string& size) {
  return with({"--scene", source_file("assets/cube.glb").string(), "--points",
               source_file("assets/finger.ply").string(), "--penetration", "3mm", "--size", size},
              more);
}

std::vector<std::string> host_touch(const std::vector<std::string>& more, const std::string& size) {
  return cube_touch(with({"--headless", "--backend", "cpu"}, more), size);
}

}  // namespace palpa::test
