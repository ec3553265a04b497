// A live loop: depth frames from a source, drives to a link, events to the program. Copy, rename, adapt.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "session/session.hpp"

/// Until the source ends or `stop` becomes true: your handler of SIGINT, SIGTERM, SIGHUP and SIGTSTP sets it.
inline palpa::session::LoopStats run_live(palpa::sensing::DepthSource& source, palpa::session::Link& link,
                                          std::vector<palpa::geometry::Solid> solids, palpa::array::Layout layout,
                                          bool every_frame, std::atomic<bool>& stop,
                                          const std::function<void(const palpa::session::Event&)>& handle) {
  palpa::session::Session session(
      {.solids = std::move(solids), .cameras = source.cameras(), .layout = std::move(layout)});
  const auto tell = [&](std::span<const palpa::session::Event> events) {
    for (const palpa::session::Event& event : events)
      handle(event);
  };
  return session.run(source, link, stop, {.every_frame = every_frame, .events = tell});
}
