// A loop of one thread: depth frames from a source, events to the program, drives to a link. Copy, rename, adapt.
#pragma once

#include <functional>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "sensing/depth_source.hpp"
#include "session/link.hpp"
#include "session/safe_link.hpp"
#include "session/toucher.hpp"

inline void run_live(palpa::sensing::DepthSource& source, palpa::session::Toucher& toucher,
                     const palpa::array::Layout& layout, palpa::session::Link& link,
                     const std::function<void(const palpa::session::Event&)>& handle) {
  // Sends silence last, on every way out of here.
  palpa::session::SafeLink safe(link, layout.transducers.size());
  palpa::array::Drive drive(layout.transducers.size());
  std::vector<palpa::array::SlotFocus> foci;
  palpa::sensing::FrameSet set;
  while (source.next(set, 0.1)) {
    if (set.frames.empty()) {  // none came for 100 ms: what the last one showed must not sound on
      safe.silence();
      continue;
    }
    toucher.touch(set.frames, set.time_s);
    for (const palpa::session::Event& event : toucher.events())
      handle(event);
    // The next frame has 100 ms to come: 66 slots.
    safe.plan({.schedule = toucher.schedule(), .from_slot = safe.next_slot(), .until_slot = safe.next_slot() + 66});
    for (int n = 0; n < 7; ++n) {  // a frame of 90 Hz lasts seven slots of 1.5 ms
      palpa::array::foci_of_slot(toucher.schedule(), safe.next_slot(), foci);
      palpa::array::drive_for(layout, foci, {}, drive);
      safe.send(safe.next_slot(), drive);
    }
  }
  safe.finish();
  for (const palpa::session::Event& event : toucher.end())  // whoever still touches lets go
    handle(event);
}
