#include "driver/autd3/emulate.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <mutex>
#include <numbers>
#include <optional>

#include "array/layout.hpp"
#include "base/error.hpp"
#include "driver/autd3/listen.hpp"
#include "driver/emulate/live_view.hpp"
#include "driver/emulate/stop.hpp"
#include "driver/emulate/trace.hpp"

namespace palpa::driver::autd3 {
namespace {

array::Layout layout_of(const std::string& name) {
  array::Layout layout = array::load_layout(name.empty() ? "autd3" : name);
  if (layout.boards.empty() || layout.boards.size() * EmulatedDevice::transducers != layout.transducers.size())
    throw bad_usage(fmt::format("the layout {} is not of AUTD3 units: name one with --layout that is", name));
  return layout;
}

/// The pulse of a device is centred, and as wide as makes its first harmonic the intensity.
array::Drive heard_drive(const EmulatedServer& server, double now_s) {
  array::Drive drive;
  for (const EmulatedDevice& device : server.devices()) {
    for (const EmulatedDevice::Output& one : device.output(now_s)) {
      const double turns = one.phase / 256.0;
      const double phase = 2 * std::numbers::pi * (turns > 0.5 ? turns - 1 : turns);
      drive.push_back({static_cast<float>(one.intensity) / 255.0f, static_cast<float>(phase)});
    }
  }
  return drive;
}

}  // namespace

void emulate(const emulate::Options& options) {
  const array::Layout layout = layout_of(options.layout);
  std::optional<emulate::TraceFile> file;
  if (!options.trace.empty()) file.emplace(options.trace);
  const double begin_s = device_time_s();

  const emulate::Stop stop;
  EmulatedServer server(layout.boards.size());
  Listener listener(static_cast<std::uint16_t>(options.port));
  fmt::print("{}\n", listener.address());
  std::fflush(stdout);

  std::mutex lock;
  std::optional<emulate::LiveView> view;
  if (options.view) {
    view.emplace(layout, [&] {
      const std::lock_guard held(lock);
      return heard_drive(server, device_time_s());
    });
  }
  std::optional<emulate::ByteTrace> trace;
  if (file) trace.emplace(*file, "tcp");
  std::size_t told = 0;
  listener.serve(server, emulate::Stop::asked(), lock, [&](std::span<const std::uint8_t> bytes) {
    if (trace) trace->bytes(device_time_s() - begin_s, bytes);
    emulate::tell_violations(options, emulate::since(begin_s, server.violations()), told);
  });
  view.reset();

  const bool sounds = !server.silent(device_time_s());
  const std::uint64_t operations = server.devices()[0].operations();
  const auto violations = emulate::since(begin_s, server.violations());
  emulate::tell_violations(options, violations, told);
  emulate::conclude(options,
                    {fmt::format("{} device{}, each told {} operations, {}", server.devices().size(),
                                 server.devices().size() == 1 ? "" : "s", operations, sounds ? "sounding" : "silent"),
                     "operations", operations, sounds, violations, server.violation_count()});
}

}  // namespace palpa::driver::autd3
