// A live loop: depth frames from a source, drives to a link, events to the program. Copy, rename, adapt.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "session/session.hpp"

/// Hands over the events of a run, on the thread that runs it.
struct Events final : palpa::session::RunObserver {
  std::function<void(const palpa::session::Event&)> handle;

  void events(std::span<const palpa::session::Event> events) override {
    for (const palpa::session::Event& event : events)
      handle(event);
  }
};

/// Until the source ends or `stop` becomes true: your handler of SIGINT, SIGTERM, SIGHUP and SIGTSTP sets it.
inline palpa::session::LoopStats run_live(palpa::sensing::DepthSource& source, palpa::session::Link& link,
                                          std::vector<palpa::geometry::Solid> solids, palpa::array::Layout layout,
                                          bool every_frame, std::atomic<bool>& stop,
                                          const std::function<void(const palpa::session::Event&)>& handle) {
  palpa::session::Session session(
      {.solids = std::move(solids), .cameras = source.cameras(), .layout = std::move(layout)});
  Events events;
  events.handle = handle;
  return session.run(source, link, stop, {.every_frame = every_frame, .observer = &events});
}
