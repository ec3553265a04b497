// What a participant feels: a live session for one method of the plan, with one shape within reach, and the gate that
// lets it sound.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "setup/options/study_options.hpp"
#include "setup/sessions/live_run.hpp"
#include "study/plan/plan.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/study/gate.hpp"
#include "viewer/study/shapes.hpp"

namespace palpa::viewer {

/// The options of a live run for one method of the plan. `scene`: the file with all shapes.
setup::LiveOptions options_of_method(const study::StudyPlan& plan, std::size_t method,
                                     const setup::StudyRunOptions& run, const std::string& scene);

/// Gives each method whose layout the plan leaves open the array that it will have: that of the rig, or else of the
/// link's own boards, or else the plan's default. Throws bad_usage if the plan gives a method a built-in array other
/// than that of the link's boards, and as the link does.
void take_layouts(study::StudyPlan& plan, const setup::StudyRunOptions& run, const LiveSession::Kinds& kinds);

/// Opens the link as each method will, and closes it again in silence. A link that does not work is thus refused before
/// anything is written. Throws as the link does.
void try_study_link(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const LiveSession::Kinds& kinds);

/// Opens the source of frames, and closes it again. Throws as the source does.
void try_study_source(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const LiveSession::Kinds& kinds);

/// Throws bad_usage for a link that writes a file, because every method would replace it; and if the rig has another
/// array than a method of the plan.
void check_study_links(const study::StudyPlan& plan, const setup::StudyRunOptions& run,
                       const LiveSession::Kinds& kinds);

class Presentation {
 public:
  using Clock = Gate::Clock;

  /// `stop` is the flag of the runs; signals set it, too. `wake` is called from other threads when there is something
  /// new. The references must outlive it. Starts nothing yet. `clock`: its gate's, and what tells whether frames still
  /// come.
  Presentation(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const StudyShapes& shapes,
               std::filesystem::path scene, const LiveSession::Kinds& kinds, std::atomic<bool>& stop,
               std::function<void()> wake, const session::Clock& clock = session::real_clock());
  /// Closes the gate and ends the session.
  ~Presentation();
  Presentation(const Presentation&) = delete;
  Presentation& operator=(const Presentation&) = delete;

  /// Wants this shape with this method. Starts a session if the method's is not under way, also after a fault. Closes
  /// the gate if anything changes.
  void prepare(std::size_t method, std::size_t shape);
  /// Takes what the session has seen, and starts the next session if the last one is over. Call it every round.
  void look();
  /// Frames come, and those of the wanted shape are played.
  bool ready() const;
  /// Why nothing can be played: the session ended although nobody asked for it, or the array takes no drives. Empty
  /// while all is well. prepare() forgets it.
  const std::string& fault() const { return fault_; }

  /// Lets it sound until then, if it is ready. Call it again and again.
  void open(Clock::time_point until);
  void close() { gate_.close(); }
  Gate& gate() { return gate_; }
  const Gate& gate() const { return gate_; }

  /// The lowest captured point over the object, in the newest frame that was looked at; nullopt if there was none.
  const std::optional<Vec3>& lowest() const { return lowest_; }
  /// How far it is below the top of the object.
  std::optional<double> deepest_m() const;
  /// What the session uses, while it runs; nullptr otherwise.
  std::shared_ptr<const LiveScene> scene() const { return session_ ? session_->scene() : nullptr; }
  double rate_hz() const { return rate_hz_; }
  /// Duration of a slot of the wanted method.
  double slot_s() const;

  /// From now on, depth images go to that new folder; empty: no more.
  void record(const std::string& folder);

  /// Silence and the end of the session. Returns whether it is over after at most that time.
  bool end(std::chrono::milliseconds patience);
  /// What that session could not do, such as to silence the array; else empty.
  const std::string& end_fault() const { return end_fault_; }

 private:
  void start();
  void place();
  void forget_seen();

  const study::StudyPlan* plan_;
  const setup::StudyRunOptions* run_;
  const StudyShapes* shapes_;
  std::filesystem::path scene_file_;
  LiveSession::Kinds kinds_;
  std::atomic<bool>* stop_;
  std::function<void()> wake_;
  Gate gate_;
  std::unique_ptr<LiveSession> session_;
  std::optional<std::size_t> method_, shape_;  ///< that are wanted
  std::optional<std::size_t> session_method_, placed_;
  std::uint64_t newest_ = 0;            ///< sequence of the newest frame that was planned
  bool may_be_old_ = false;             ///< the next snapshot, because the shape was just placed
  std::optional<std::uint64_t> since_;  ///< frames from here on have the shape that is placed
  std::optional<double> since_s_;       ///< the capture time of the first of them that was looked at
  bool wanted_ = false;                 ///< a session should be under way
  std::string fault_, end_fault_;
  std::optional<Vec3> lowest_;
  std::optional<Clock::time_point> seen_at_;
  double rate_hz_ = 0;
};

}  // namespace palpa::viewer
