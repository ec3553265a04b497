// Runs a participant's sitting in front of an array: passes keys, depths, faults and the time to the sitting, lets the
// array sound while the sitting says so, and writes what was played. It knows no window.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "setup/options/study_options.hpp"
#include "study/plan/plan.hpp"
#include "study/sitting/ear_level.hpp"
#include "study/sitting/finger_recorder.hpp"
#include "study/sitting/record.hpp"
#include "study/sitting/sitting.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/study/masking.hpp"
#include "viewer/study/presentation.hpp"
#include "viewer/study/views.hpp"

namespace palpa::viewer {

/// The entry with which a program begins, or continues, a sitting.
study::Entry start_entry(const setup::StudyRunOptions& run, const std::string& masking);

/// What was lost, for the experimenter; empty if nothing was.
std::string to_text(const study::TouchLosses& losses);

class Conductor {
 public:
  using Clock = std::chrono::steady_clock;

  /// Continues the participant, or begins. `level`: as predicted or measured for this plan. The references must outlive
  /// it. `clock`: the sitting's. Throws as study::Record, Masking, try_study_source() and try_study_link() do; a
  /// participant's files are then as they were.
  Conductor(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const StudyShapes& shapes,
            const study::EarLevel& level, const LiveSession::Kinds& kinds, std::atomic<bool>& stop,
            std::function<void()> wake, const session::Clock& clock = session::real_clock());

  /// Keys and clicks in the participant's window. `button`: that the pointer is on.
  void participant(const WindowEvent& event, std::optional<std::size_t> button);
  /// The same for the experimenter's.
  void experimenter(const WindowEvent& event, std::optional<std::size_t> button);
  /// Silence, and the end. The same command continues.
  void stop();

  /// Call it every round of the program's loop: at least every wait_s().
  void advance();
  /// How long the loop may wait for events.
  double wait_s() const;
  /// Nothing follows any more.
  bool over() const;

  ParticipantView participant_view() const;
  ExperimenterView experimenter_view() const;

  const study::Sitting& sitting() const { return *sitting_; }
  const study::Record& record() const { return record_; }
  Presentation& presentation() { return *presentation_; }

 private:
  std::int64_t ns_of(std::int64_t steady_ns) const;
  std::int64_t now_ns() const;
  void act(study::Act act, std::int64_t at_ns);
  void command(Command command, std::int64_t at_ns);
  std::string end_touch();
  void wait_for_arrivals() const;
  study::TouchLosses losses() const;
  void follow_touch();
  bool keeps_depth() const;
  std::string next_file(const std::string& end) const;
  bool silences(study::Act act) const;
  void tell_step(ExperimenterView& view) const;
  void tell_array(ExperimenterView& view) const;
  void tell_finger(ExperimenterView& view) const;
  void tell_level(ExperimenterView& view) const;
  void offer_commands(ExperimenterView& view) const;
  bool answers_early(const std::optional<std::size_t>& button);
  void write(study::Entry entry);

  const study::StudyPlan* plan_;
  const setup::StudyRunOptions* run_;
  const StudyShapes* shapes_;
  study::EarLevel level_;
  std::optional<Masking> masking_;
  study::Record record_;
  const session::Clock* clock_;
  Clock::time_point begin_ = time_of(*clock_);     ///< on that clock
  Clock::time_point system_begin_ = Clock::now();  ///< the same moment on the clock of the windows' events
  std::unique_ptr<study::Sitting> sitting_;
  std::uint32_t run_number_ = 0;
  std::unique_ptr<Presentation> presentation_;
  std::optional<study::FingerRecorder> finger_;
  bool touching_ = false;                    ///< a touch is under way that was begun here
  bool told_fault_ = false;                  ///< the sitting knows of the presentation's fault
  bool early_ = false;                       ///< the participant has answered before the question
  std::optional<std::int64_t> answered_ns_;  ///< when the participant last answered a question or a consent page
  study::TouchLosses last_losses_;           ///< of the touch under way, or of the last one
  std::uint32_t touches_ = 0;                ///< of this run
  double written_s_ = 0;                     ///< how much of the sound of this run is in the journal
};

}  // namespace palpa::viewer
