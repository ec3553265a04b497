// `palpa simulate`: its options, and the paper's figure of several touches.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "setup/options/options.hpp"
#include "setup/tasks/simulate.hpp"

namespace palpa::cli {

struct SimulateCommand {
  setup::CommonOptions common;
  std::string scene, finger;
  std::optional<std::uint32_t> gltf_scene;
  bool figure6 = false;
  bool force = false;
  std::string csv, vtu, png;
  setup::SolidOptions solids;
  setup::SimulateTask task;
};

/// The finger given by --finger, for the air of the options.
setup::FingerBody load_finger(const SimulateCommand& o);

/// The paper's objects, one after the other, with every method: table, --json, --png.
void run_figure6(const SimulateCommand& o);

}  // namespace palpa::cli
