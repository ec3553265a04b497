// A sounding schedule without a session.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "viewer/sound/sounding.hpp"

namespace palpa::test {

/// A finger's schedule: four foci around a point above a board. With fewer of the board's transducers, its field takes
/// less time to compute.
class Played {
 public:
  explicit Played(const Vec3& centre = {0, 0, 0.1}, std::size_t transducers = 256) {
    array::Layout layout = array::load_layout("openmpd");
    if (transducers < layout.transducers.size()) {
      layout.transducers.resize(transducers);
      layout.boards.clear();
    }
    now.layout = std::make_shared<const array::Layout>(std::move(layout));
    now.air = acoustics::without_absorption(acoustics::air_of({}));
    move(centre);
  }
  void move(const Vec3& centre) {
    plan_ = {};
    array::Voice& voice = plan_.schedule.add_voice();
    for (const auto& [x, y] : {std::pair(3e-3, 0.0), {0.0, 3e-3}, {-3e-3, 0.0}, {0.0, -3e-3}})
      voice.foci.push_back(centre + Vec3(x, y, 0));
    voice.order = {0, 3, 2, 1};
    voice.modulation_hz = 0;
    session::SlotWork work;
    array::SlotDrives slots;
    session::drive_on_host(plan_, *now.layout, now.drive, work, nullptr, slots);
    now.plan = &plan_;
    now.schedule = &plan_.schedule;
    now.slot = plan_.drive(0, now.layout->transducers.size());
  }
  viewer::Sounding now;

 private:
  session::Plan plan_;
};

}  // namespace palpa::test
