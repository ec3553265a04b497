// The chain of a session on the host, frame by frame: contacts, clusters, fingers, foci, prediction, schedule and
// events, as session/plan/planner.cpp runs them. Unlike a session, it can leave out rules of hysteresis.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "array/schedule.hpp"
#include "hand_classes.hpp"
#include "session/plan/planner.hpp"
#include "session/plan/scheduler.hpp"
#include "session/predict/predictor.hpp"
#include "session/watch/events.hpp"
#include "touch/stage.hpp"

namespace palpa::test {

class HandChain {
 public:
  HandChain(const RatedHand& hand, const touch::HysteresisRules& rules);

  void see(std::span<const sensing::DepthFrame> images, double time_s);
  // The results of the newest frame.
  const touch::Touch& seen() const { return touch_; }
  const array::Schedule& schedule() const { return schedule_; }
  std::span<const session::Event> events() const { return events_; }
  /// From its capture to the time for which its foci are predicted; 0 without prediction.
  double ahead_s() const { return ahead_s_; }

 private:
  session::SessionSetting setting_;
  session::Scheduler scheduler_;
  touch::Stage stage_;
  std::optional<session::Predictor> predictor_;
  session::KeptFrames kept_;
  session::EventTracker tracker_;
  touch::Touch touch_;
  array::Schedule schedule_;
  std::span<const session::Event> events_;
  std::uint32_t cycle_ = 0;
  double ahead_s_ = 0;
};

}  // namespace palpa::test
