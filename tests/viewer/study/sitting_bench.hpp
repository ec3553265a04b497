// A participant's sitting in this process: a small plan, a synthetic finger, and a link that records what it is given.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "sensing/synthetic.hpp"
#include "session/forward_clock.hpp"
#include "session/links/sources.hpp"
#include "study/plan/plan_file.hpp"
#include "support/begins.hpp"
#include "support/study_files.hpp"
#include "viewer/live/heard_link.hpp"
#include "viewer/study/conductor.hpp"
#include "viewer/study/scripted_keys.hpp"
#include "viewer/study/study_plan.hpp"

namespace palpa::test {

/// The finger is pressed this far below the top of the objects.
inline std::atomic<double> finger_depth_m{3e-3};

class SittingBench {
 public:
  SittingBench(const std::filesystem::path& folder, const std::filesystem::path& plan)
      : plan_(study::read_plan(plan)), shapes_(viewer::load_shapes(plan_)) {
    run_.participant = 1;
    run_.out = (folder / "study").string();
    run_.common.backend = setup::Backend::cpu;
    run_.rig = write_study_rig(folder).string();
    run_.source = "pressed";
    run_.link = "heard";
    run_.hold_s = 5;
    run_.rehearse = 0.5;
  }
  ~SittingBench() { end(); }

  setup::StudyRunOptions& options() { return run_; }
  /// What begin() gives the sitting.
  study::EarLevel& level() { return level_; }
  /// The sitting's.
  ForwardClock& clock() { return clock_; }
  const study::StudyPlan& plan() const { return plan_; }
  viewer::Conductor& conductor() { return *conductor_; }
  const study::Sitting& sitting() const { return conductor_->sitting(); }
  const std::shared_ptr<HeardSound>& heard() const { return heard_; }

  /// Starts the program, so to speak.
  void begin() {
    stop_ = false;
    heard_ = std::make_shared<HeardSound>();
    viewer::LiveSession::Kinds kinds;
    kinds.links.push_back(heard_link(heard_));
    kinds.sources.push_back(session::synthetic_source("pressed", "", [](double) {
      Transform pose(1.0);
      pose[3][1] = -finger_depth_m;
      return pose;
    }));
    script_.emplace(run_.rehearse.value_or(0.5), 1, run_.common.seed);
    conductor_ = std::make_unique<viewer::Conductor>(
        plan_, run_, shapes_, level_, kinds, stop_, [] {}, clock_);
    heard_->opened = 0;  // it was only tried
    heard_->finished = false;
  }
  /// The program is killed.
  void end() { conductor_.reset(); }

  /// Goes on until the condition holds: false if it does not in time. `keys`: the scripted people press them.
  template <typename Condition>
  bool goes_until(Condition condition, bool keys = true) {
    return begins([&] {
      if (condition()) return true;
      if (keys) {
        if (auto press = script_->next(plan_, *conductor_)) {
          press->event.at_ns = now().count();
          press->experimenter ? conductor_->experimenter(press->event, std::nullopt)
                              : conductor_->participant(press->event, std::nullopt);
        }
        if (condition()) return true;  // a short touch may be over after one advance() of a busy machine
      }
      conductor_->advance();
      return false;
    });
  }
  bool reaches(study::Screen screen, bool keys = true) {
    return goes_until([&] { return sitting().screen() == screen; }, keys);
  }
  /// Goes on without keys for that time.
  void passes(std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    goes_until([&] { return std::chrono::steady_clock::now() > until; }, false);
  }
  /// A click of the participant on a button, or beside all of them, now or at another time. Returns its time.
  std::chrono::nanoseconds click(std::optional<std::size_t> button,
                                 std::optional<std::chrono::nanoseconds> at = std::nullopt) {
    const std::chrono::nanoseconds time = at.value_or(now());
    conductor_->participant({.kind = viewer::WindowEvent::Kind::press, .at_ns = time.count()}, button);
    return time;
  }
  void press(viewer::Key key, bool experimenter = false) {
    const viewer::WindowEvent event{.kind = viewer::WindowEvent::Kind::key, .at_ns = now().count(), .key = key};
    experimenter ? conductor_->experimenter(event, std::nullopt) : conductor_->participant(event, std::nullopt);
  }
  /// Whether the link gets nothing but silence from a moment on.
  bool is_silent() {
    const std::uint64_t under_way = heard_->drives + 1;
    if (!goes_until([&] { return !heard_->last_sounds && (heard_->finished || heard_->drives > under_way); }, false))
      return false;
    const std::uint64_t before = heard_->sounding;
    passes(std::chrono::milliseconds(100));
    return heard_->sounding == before && !heard_->last_sounds;
  }

 private:
  /// As windows tell it.
  std::chrono::nanoseconds now() const {
    const std::chrono::duration<double> ahead(clock_.ahead_s());
    return std::chrono::steady_clock::now().time_since_epoch() +
           std::chrono::duration_cast<std::chrono::nanoseconds>(ahead);
  }

  ForwardClock clock_;
  study::StudyPlan plan_;
  viewer::StudyShapes shapes_;
  setup::StudyRunOptions run_;
  study::EarLevel level_{.db = {100, 101}, .sounding_s = 10};
  std::atomic<bool> stop_{false};
  std::shared_ptr<HeardSound> heard_ = std::make_shared<HeardSound>();
  std::optional<viewer::ScriptedKeys> script_;
  std::unique_ptr<viewer::Conductor> conductor_;
};

}  // namespace palpa::test
