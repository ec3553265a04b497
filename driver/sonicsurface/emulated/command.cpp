#include "driver/sonicsurface/emulated/command.hpp"

#include <fmt/core.h>

#include <numbers>
#include <span>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/system/now.hpp"
#include "base/text.hpp"
#include "driver/emulate/serve.hpp"
#include "driver/emulate/stop.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/emulated/pty.hpp"

namespace palpa::driver::sonicsurface {
namespace {

array::Layout layout_of(const emulate::Options& options) {
  array::Layout layout = array::load_layout(options.layout.empty() ? "sonicsurface" : options.layout);
  const std::size_t boards = layout.boards.size();
  if (boards == 0 || boards > (options.tactile ? 1 : 2) ||
      boards * EmulatedBoards::slots != layout.transducers.size()) {
    throw bad_usage(fmt::format("the layout {} does not consist of {}: give --layout one that does", options.layout,
                                options.tactile ? "one SonicSurface board" : "one or two SonicSurface boards"));
  }
  return layout;
}

array::Drive heard_drive(const EmulatedBoards& machine, std::span<const float> degrees, std::size_t boards) {
  array::Drive drive;
  for (std::size_t t = 0; t < boards * EmulatedBoards::slots; ++t) {
    const std::size_t board = t / EmulatedBoards::slots, own = t % EmulatedBoards::slots;
    const int phase = machine.sounding(board, own);
    const double late = (degrees.empty() ? 0 : degrees[t] / 360.0) + machine.late_periods(board, own);
    const double turns = phase / 32.0 + late;
    const bool sounds = phase != EmulatedBoards::silent;
    drive.push_back({sounds ? 1.0f : 0.0f, static_cast<float>(sounds ? 2 * std::numbers::pi * turns : 0)});
  }
  return drive;
}

}  // namespace

void emulate(const emulate::Options& options, const Outputs& outputs) {
  const array::Layout layout = layout_of(options);
  const std::vector<float> degrees = read_degrees(options.files, layout.transducers.size());
  const emulate::Stop ends;  // until everything is printed
  const double begin_s = monotonic_s();
  EmulatedBoards machine(layout.boards.size(), options.tactile);
  const Pty pty;
  const auto violations = emulate::serve(
      options,
      {.address = pty.path(),
       .wire = "serial",
       .layout = layout,
       .begin_s = begin_s,
       .now_s = monotonic_s,
       .heard = [&] { return heard_drive(machine, degrees, layout.boards.size()); },
       .violations = [&] { return machine.violations().kept(); },
       .serve = [&](const auto& stop, auto& lock, const auto& took) { pty.serve(machine, stop, lock, took); }});
  const bool sounds = !machine.all_silent() || !machine.all_silent_behind();
  emulate::conclude(options, outputs,
                    {fmt::format("{}, {}, {}", counted(machine.bytes(), "byte"), counted(machine.swaps(), "swap"),
                                 sounds ? "sounding" : "silent"),
                     "bytes", machine.bytes(), sounds, violations, machine.violations().count()});
}

}  // namespace palpa::driver::sonicsurface
