#include "driver/autd3/emulated/command.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "driver/autd3/emulated/listener.hpp"
#include "driver/emulate/serve.hpp"
#include "driver/emulate/stop.hpp"

namespace palpa::driver::autd3 {
namespace {

array::Layout layout_of(const std::string& name) {
  array::Layout layout = array::load_layout(name.empty() ? "autd3" : name);
  if (layout.boards.empty() || layout.boards.size() * EmulatedDevice::transducers != layout.transducers.size())
    throw bad_usage(fmt::format("the layout {} does not consist of AUTD3 units: give --layout one that does", name));
  return layout;
}

/// A device's pulse is centred, and as wide as its table has it for the intensity.
array::Drive heard_drive(const EmulatedServer& server, double now_s) {
  array::Drive drive;
  for (const EmulatedDevice& device : server.devices()) {
    for (const EmulatedDevice::Output& one : device.output(now_s)) {
      const double turns = one.phase / 256.0;
      const double phase = 2 * std::numbers::pi * (turns > 0.5 ? turns - 1 : turns);
      const double counts = std::round(std::asin(one.intensity / 255.0) * 512 / std::numbers::pi);
      drive.push_back({static_cast<float>(std::sin(std::numbers::pi * counts / 512)), static_cast<float>(phase)});
    }
  }
  return drive;
}

}  // namespace

void emulate(const emulate::Options& options, const Outputs& outputs) {
  const array::Layout layout = layout_of(options.layout);
  const double begin_s = device_time_s();
  const emulate::Stop ends;  // until everything is printed
  EmulatedServer server(layout.boards.size());
  Listener listener(static_cast<std::uint16_t>(options.port.value_or(emulate::default_port)));
  const auto violations = emulate::serve(
      options,
      {.address = listener.address(),
       .wire = "tcp",
       .layout = layout,
       .begin_s = begin_s,
       .now_s = device_time_s,
       .heard = [&] { return heard_drive(server, device_time_s()); },
       .violations = [&] { return server.violations(); },
       .serve = [&](const auto& stop, auto& lock, const auto& took) { listener.serve(server, stop, lock, took); }});
  const bool sounds = !server.silent(device_time_s());
  const std::uint64_t operations = server.devices()[0].operations();
  emulate::conclude(options, outputs,
                    {fmt::format("{}, {} each, {}", counted(server.devices().size(), "device"),
                                 counted(operations, "operation"), sounds ? "sounding" : "silent"),
                     "operations", operations, sounds, violations, server.violation_count()});
}

}  // namespace palpa::driver::autd3
