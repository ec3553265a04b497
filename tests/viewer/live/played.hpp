// A sounding schedule without a session, and a wait for background computations.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <thread>
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

/// `rest`: pause between two checks; with none, an answer may come at any moment of a check.
template <typename Condition>
bool soon(Condition condition, std::chrono::milliseconds rest = std::chrono::milliseconds(2)) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(rest);
  }
  return true;
}

}  // namespace palpa::test
