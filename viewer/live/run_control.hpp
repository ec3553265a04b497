// The live run: which session there is, and what follows it.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "viewer/live/live_session.hpp"
#include "viewer/live/next_outputs.hpp"
#include "viewer/live/starter.hpp"

namespace palpa::viewer {

/// The state of a run. A session takes time to end, so what follows it is also part of the state.
///
///   none, ended, failed      --change, start-->  ready          switched_off    --start-->    ready
///   loading, running         --change, start-->  restarting     switching_off   --start-->    restarting
///   loading, running, restarting --switch_off--> switching_off  ended, failed, ready --switch_off--> switched_off
///   ready                    --begin----------->  loading        ready           --stay----->  ended
///
/// advance() also changes the state when the session has got further: loading to running, loading and running to ended
/// or failed, restarting to ready, switching_off to switched_off. What is not listed changes nothing.
enum class RunState {
  none,           ///< there is no session: a single touch is shown, or a signal came before begin()
  loading,        ///< the session opens what its options name
  running,        ///< frames come
  ended,          ///< the session ended by itself: its source ended, a signal came, the window did not answer
  failed,         ///< the session ended because of a fault
  restarting,     ///< the session is ending, and another will begin then
  ready,          ///< no session is under way; begin() begins the next
  switching_off,  ///< the run was switched off: the session is silent, but not over yet
  switched_off,   ///< the same, and the session is over; only start() begins another
};

class RunControl {
 public:
  /// `kinds` are in addition to palpa's own. `stop` ends the run and may also be set from outside. `wake` is called on
  /// other threads when something is new. See LiveSession. Sessions do not give way, even if the calling thread does
  /// later.
  RunControl(LiveSession::Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake);

  RunState state() const { return state_; }
  /// Whether another session follows by itself.
  bool restarts() const { return state_ == RunState::restarting || state_ == RunState::ready; }
  /// Whether there is a session whose end advance() has not seen yet.
  bool under_way() const;

  /// Gives the run these options. A session that is under way ends, and another begins. A run that is switched off will
  /// start with these options.
  void change(setup::LiveOptions options);
  /// The same, but starts a run that is switched off, too.
  void start(setup::LiveOptions options);
  /// Sets the ceiling of the session that is under way, and of those that follow. No session ends or begins.
  void set_ceiling(double ceiling);
  /// Silence from the next slot on; nothing begins until start(). Returns whether it was not switched off before.
  bool switch_off();
  /// Must be called again and again. Returns each session's fault once, when the session is over; empty if it did not
  /// fail.
  std::optional<std::string> advance();
  /// Begins a session if the state is ready; the session before it is over then. Returns a line for each output that
  /// has another name than the options say (NextOutputs). After a signal (setup::Interrupt), no session begins and the
  /// result is nullopt.
  std::optional<std::vector<std::string>> begin();
  /// Nothing follows: a session that is ready to begin does not.
  void stay();

  /// The options of the session that exists, or of the one that was begun last.
  const setup::LiveOptions& options() const { return options_; }
  /// The options of the session that begin() will begin.
  const setup::LiveOptions& next() const { return next_; }
  /// The session, until the next one begins; null before the first.
  LiveSession* session() { return session_.get(); }
  const LiveSession* session() const { return session_.get(); }
  /// Whether the session loads, whatever follows it.
  bool loading() const { return session_ && session_->state() == LiveState::loading; }

  /// Whether the session's scene has become available since the last call.
  bool take_scene();
  /// The scene as take_scene() found it; null if it has not found one yet.
  const std::shared_ptr<const LiveScene>& scene() const { return scene_; }

  /// Silences and ends the session. Returns false if it is not over within `patience_s`, or loads all that time.
  bool finish(double patience_s);

 private:
  LiveSession::Kinds kinds_;
  std::atomic<bool>* stop_;
  std::function<void()> wake_;
  RunState state_ = RunState::none;
  setup::LiveOptions options_, next_;
  Starter starter_;
  NextOutputs outputs_;
  bool loud_ = false;                ///< the session plays at full amplitude because nobody chose a ceiling
  std::set<std::string> told_loud_;  ///< links of which a session has said so
  std::unique_ptr<LiveSession> session_;
  std::shared_ptr<const LiveScene> scene_;
};

}  // namespace palpa::viewer
