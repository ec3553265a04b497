// The options of `palpa touch`, `drive`, `field` and `simulate`: what each of them reads from a command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "setup/options.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"
#include "setup/tasks/simulate.hpp"
#include "setup/tasks/touch.hpp"
#include "setup/touch_input.hpp"

namespace CLI {
class App;
}

namespace palpa::setup {

struct TouchLine {
  CommonOptions common;
  TouchInputOptions input;
  TouchTask task;
  std::string csv;
};
/// Adds all options except the common ones, in the order of the help.
void add_options(CLI::App& app, TouchLine& line);
/// Hands the common options to the task, and checks all. Throws bad_usage for options that do not fit together.
void settle(TouchLine& line);

struct DriveLine {
  CommonOptions common;
  DriveTask task;
  std::string csv;
};
void add_options(CLI::App& app, DriveLine& line);
void settle(DriveLine& line);

struct FieldLine {
  CommonOptions common;
  FieldTask task;
  std::string csv, vtu, png;
};
void add_options(CLI::App& app, FieldLine& line);
void settle(FieldLine& line);

struct SimulateLine {
  CommonOptions common;
  std::string scene, finger;
  std::optional<std::uint32_t> gltf_scene;
  bool figure6 = false;
  bool force = false;
  std::string csv, vtu, png;
  SolidOptions solids;
  SimulateTask task;
};
void add_options(CLI::App& app, SimulateLine& line);
void settle(SimulateLine& line);

}  // namespace palpa::setup
