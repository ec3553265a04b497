// A loop of one thread: depth frames from a source, events to the program, drives to a link. Copy, rename, adapt.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "base/error.hpp"
#include "sensing/depth_source.hpp"
#include "session/link.hpp"
#include "session/toucher.hpp"

/// Silence, which is the last thing that the link gets on every way out of the loop.
struct Silence {
  palpa::session::Link& link;
  palpa::array::Drive drive;
  std::uint64_t slot = 0;  // the next one to be sent
  bool ended = false;

  Silence(palpa::session::Link& silenced, std::size_t transducers) : link(silenced), drive(transducers, {0, 0}) {}
  Silence(const Silence&) = delete;
  ~Silence() {
    try {
      end();
    } catch (const palpa::Error&) {  // the loop's own error is the one to report
    }
  }
  void send() {
    link.foci({});
    link.send(slot++, drive);
  }
  void end() {
    if (ended) return;
    ended = true;
    send();
    link.finish();
  }
};

inline void run_live(palpa::sensing::DepthSource& source, palpa::session::Toucher& toucher,
                     const palpa::array::Layout& layout, palpa::session::Link& link,
                     const std::function<void(const palpa::session::Event&)>& handle) {
  Silence silence(link, layout.transducers.size());
  palpa::array::Drive drive(layout.transducers.size());
  std::vector<palpa::array::SlotFocus> foci;
  palpa::sensing::FrameSet set;
  while (source.next(set, 0.1)) {
    if (set.frames.empty()) {  // none came for 100 ms: what the last one showed must not sound on
      silence.send();
      continue;
    }
    toucher.touch(set.frames, set.time_s);
    for (const palpa::session::Event& event : toucher.events())
      handle(event);
    link.foci(toucher.schedule());
    for (int n = 0; n < 7; ++n) {  // a frame of 90 Hz lasts seven slots of 1.5 ms
      palpa::array::foci_of_slot(toucher.schedule(), silence.slot, foci);
      palpa::array::drive_for(layout, foci, {}, drive);
      link.send(silence.slot++, drive);
    }
  }
  silence.end();
  for (const palpa::session::Event& event : toucher.end())  // whoever still touches lets go
    handle(event);
}
