// The live loop of three threads, with events to the program. Copy, rename, adapt.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "array/layout.hpp"
#include "geometry/solid.hpp"
#include "sensing/depth_source.hpp"
#include "session/events.hpp"
#include "session/loop.hpp"
#include "session/overrides.hpp"

/// Until the source ends or `stop` becomes true: your handler of SIGINT, SIGTERM, SIGHUP and SIGTSTP sets it.
inline palpa::session::LoopStats run_with_events(palpa::sensing::DepthSource& source, palpa::session::Link& link,
                                                 const std::vector<palpa::geometry::Solid>& solids,
                                                 const palpa::array::Layout& layout, bool every_frame,
                                                 std::atomic<bool>& stop,
                                                 const std::function<void(const palpa::session::Event&)>& handle) {
  palpa::session::ChainSetting setting{.cameras = source.cameras(), .solids = solids, .layout = layout};
  setting.touch.deep = true;                        // depths beyond --delta, or a press 3 mm deep never comes
  setting.detail = palpa::touch::Detail::contacts;  // the report says how deep fingers are
  setting.slot_s = palpa::session::slot_length(solids, setting.voice);
  const auto chain = palpa::session::make_cpu_chain(setting);  // or make_gpu_chain(device, setting)

  palpa::session::EventTracker tracker(solids);
  palpa::session::LoopObservers observers;
  observers.planned = [&](const palpa::session::FrameReport& report, const palpa::session::Plan&) {
    for (const palpa::session::Event& event : tracker.update(*report.touch, report.time_s))
      handle(event);
  };
  observers.expired = [&] {
    for (const palpa::session::Event& event : tracker.expire())
      handle(event);
  };
  palpa::session::LoopStats stats;
  palpa::session::run_loop(source, *chain, link,
                           {.output = {.layout = layout, .slot_s = setting.slot_s}, .every_frame = every_frame}, stop,
                           observers, stats);
  for (const palpa::session::Event& event : tracker.end())  // whoever still touches lets go
    handle(event);
  return stats;
}
