#include "sweep/commands.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "array/layouts/layout.hpp"
#include "setup/spread.hpp"

namespace palpa::sweep {
namespace {

/// These belong to the command line of the sweep: what computes, what is printed, and files for one case only.
constexpr std::array<std::string_view, 8> of_the_sweep{"--gpu",        "--backend", "--quiet",         "--log-level",
                                                       "--validation", "--json",    "--allow-outside", "--figure6"};

std::unique_ptr<Line> new_line(const std::string& command) {
  if (command == "touch") return std::make_unique<Line>(std::in_place_type<setup::TouchLine>);
  if (command == "drive") return std::make_unique<Line>(std::in_place_type<setup::DriveLine>);
  if (command == "field") return std::make_unique<Line>(std::in_place_type<setup::FieldLine>);
  return std::make_unique<Line>(std::in_place_type<setup::SimulateLine>);
}

/// The line's options on a command line of their own; the line must outlive it.
std::unique_ptr<CLI::App> options_of(Line& line) {
  auto app = std::make_unique<CLI::App>();
  std::visit(
      [&](auto& of_command) {
        setup::add_options(*app, of_command);
        setup::add_common(*app, of_command.common);
      },
      line);
  return app;
}

std::vector<setup::OptionInfo> options_of(const std::string& command) {
  const std::unique_ptr<Line> line = new_line(command);
  std::vector<setup::OptionInfo> options = setup::option_table(*options_of(*line));
  std::erase_if(options, [](const setup::OptionInfo& option) {
    const bool writes = option.type == "FILE|-" || option.name == "--png" || option.name == "--vtu";
    return writes || std::ranges::find(of_the_sweep, option.name) != of_the_sweep.end();
  });
  return options;
}

/// Adds what a finger has with --spectrum and --tune.
std::vector<Structure> with_felt(std::vector<Structure> structures) {
  const Structure felt[] = {{"fingers", "0"},
                            {"fingers.#", "solid"},
                            {"fingers.#.spectrum", "felt_share"},
                            {"fingers.#.spectrum.skin_m", "0"},
                            {"fingers.#.spectrum.lines", "0"},
                            {"fingers.#.spectrum.lines.#", "frequency_hz"},
                            {"fingers.#.tune", "stride"}};
  std::ranges::copy(felt, std::back_inserter(structures));
  return structures;
}

Command touch_command() {
  return {"touch",
          {},
          {"points", "contacts.count", "contacts.depths_m.max", "fingers.count", "fingers.0.indices.count",
           "fingers.0.centroid_m.0", "fingers.0.centroid_m.1", "fingers.0.centroid_m.2", "fingers.0.eigenvalues_m2.0",
           "fingers.0.eigenvalues_m2.1", "fingers.0.foci_m.count", "fingers.0.pressures_pa.min",
           "fingers.0.pressures_pa.max"},
          with_felt({{"contacts", "count"},
                     {"contacts.indices", "0"},
                     {"contacts.depths_m", "0"},
                     {"fingers.#.indices", "0"},
                     {"fingers.#.centroid_m", "0"},
                     {"fingers.#.axes", "0"},
                     {"fingers.#.axes.#", "0"},
                     {"fingers.#.eigenvalues_m2", "0"},
                     {"fingers.#.foci_m", "0"},
                     {"fingers.#.foci_m.#", "0"},
                     {"fingers.#.focus_points", "0"},
                     {"fingers.#.pressures_pa", "0"},
                     {"fingers.#.schedule", "dwell_s"},
                     {"fingers.#.schedule.order", "0"},
                     {"fingers.#.schedule.order.#", "0"},
                     {"schedule", "dwell_s"},
                     {"schedule.order", "0"},
                     {"schedule.order.#", "0"}})};
}

Command drive_command() {
  return {"drive",
          {},
          {"transducers", "sound_speed_m_s", "frequency_hz", "pressures_pa.min", "pressures_pa.max",
           "weakest_to_strongest", "amplitudes.min", "amplitudes.mean", "amplitudes.max"},
          {{"foci_m", "0"},
           {"foci_m.#", "0"},
           {"aimed_m", "0"},
           {"aimed_m.#", "0"},
           {"solution", "iterations"},
           {"gains", "0"},
           {"pressures_pa", "0"},
           {"over_free_field", "0"},
           {"unresolved_pairs", "0"},
           {"unresolved_pairs.#", "0"},
           {"amplitudes", "0"},
           {"phases_rad", "0"},
           {"spread", "draws"},
           {"spread.pressures_pa", "0"},
           {"spread.pressures_pa.#", "0"},
           {"spread.weakest_to_strongest", "0"}}};
}

Command field_command() {
  return {
      "field",
      {},
      {"points", "peak_pa", "peak_m.0", "peak_m.1", "peak_m.2", "sound_speed_m_s", "density_kg_m3", "absorption_np_m"},
      {{"peak_m", "0"},
       {"spread", "draws"},
       {"spread.peak_pa", "0"},
       {"spread.peak_m", "0"},
       {"spread.peak_m.#", "0"}}};
}

Command simulate_command() {
  return {"simulate",
          {},
          {"finger.faces", "langevin.peak_pa", "langevin.half_area_m2", "langevin.half_radius_m", "langevin.elongation",
           "squared.peak_pa", "squared.half_area_m2", "squared.half_radius_m", "squared.elongation", "force_N.0",
           "force_N.1", "force_N.2", "force_far_N.1", "torque_Nm.0", "torque_Nm.1", "torque_Nm.2"},
          with_felt({{"finger", "faces"},
                     {"foci_m", "0"},
                     {"foci_m.#", "0"},
                     {"aimed_m", "0"},
                     {"aimed_m.#", "0"},
                     {"langevin", "peak_pa"},
                     {"langevin.peak_m", "0"},
                     {"squared", "peak_pa"},
                     {"squared.peak_m", "0"},
                     {"force_N", "0"},
                     {"force_far_N", "0"},
                     {"torque_Nm", "0"},
                     {"solution", "iterations"},
                     {"spread", "draws"},
                     {"spread.langevin", "peak_pa"},
                     {"spread.langevin.peak_pa", "0"},
                     {"spread.langevin.peak_m", "0"},
                     {"spread.langevin.peak_m.#", "0"},
                     {"spread.langevin.half_area_m2", "0"},
                     {"spread.langevin.half_radius_m", "0"},
                     {"spread.langevin.elongation", "0"},
                     {"spread.squared", "peak_pa"},
                     {"spread.squared.peak_pa", "0"},
                     {"spread.squared.peak_m", "0"},
                     {"spread.squared.peak_m.#", "0"},
                     {"spread.squared.half_area_m2", "0"},
                     {"spread.squared.half_radius_m", "0"},
                     {"spread.squared.elongation", "0"},
                     {"spread.force_N", "0"},
                     {"spread.force_N.#", "0"},
                     {"spread.torque_Nm", "0"},
                     {"spread.torque_Nm.#", "0"}})};
}

std::vector<Command> all_commands() {
  std::vector<Command> commands{touch_command(), drive_command(), field_command(), simulate_command()};
  for (Command& command : commands)
    command.options = options_of(command.name);
  return commands;
}

const std::vector<Command>& commands() {
  static const std::vector<Command> all = all_commands();
  return all;
}

}  // namespace

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command& command : commands())
    names.push_back(command.name);
  return names;
}

const Command& command_of(const std::string& name) {
  return *std::ranges::find(commands(), name, &Command::name);
}

void check_value(const Command& command, const Setting& setting) {
  if (!setting.given) return;
  // A plan may have very many values, and adding the options takes longer than reading one.
  struct Reader {
    std::unique_ptr<Line> line;
    std::unique_ptr<CLI::App> app;
  };
  static std::mutex mutex;
  static std::map<std::string, Reader> readers;
  const std::lock_guard lock(mutex);
  Reader& reader = readers[command.name];
  if (!reader.app) {
    reader.line = new_line(command.name);
    reader.app = options_of(*reader.line);
  }
  setup::read_given(*reader.app, given_by({setting}));
}

std::string file_in(const setup::OptionInfo& option, const std::string& value) {
  if (option.name == "--spread") return std::string(setup::rig_of_spread(value));
  if (option.type == "FILE") return value;
  if (option.type != "NAME|FILE") return {};
  const std::vector<std::string> names = array::layout_names();
  return std::ranges::find(names, value) == names.end() ? value : "";
}

std::unique_ptr<Line> read_line(const Command& command, const setup::Given& given) {
  std::unique_ptr<Line> line = new_line(command.name);
  setup::read_given(*options_of(*line), given);
  return line;
}

void check_line(Line& line) {
  std::visit([](auto& of_command) { settle(of_command); }, line);
}

}  // namespace palpa::sweep
