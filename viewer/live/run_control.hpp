// The live run: which session there is, and what follows it.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/live/live_session.hpp"
#include "viewer/live/next_outputs.hpp"
#include "viewer/live/starter.hpp"

namespace palpa::viewer {

/// Where a run stands. A session ends in its own time, so what follows it is a state, too.
///
///   none, ended, failed      --change, start-->  ready          switched_off    --start-->    ready
///   loading, running         --change, start-->  restarting     switching_off   --start-->    restarting
///   loading, running, restarting --switch_off--> switching_off  ended, failed, ready --switch_off--> switched_off
///   ready                    --begin----------->  loading        ready           --stay----->  ended
///
/// and where advance() finds the session further than before: loading to running, loading and running to ended or
/// failed, restarting to ready, switching_off to switched_off. What is not listed changes nothing.
enum class RunState {
  none,           ///< there is no session: a single touch is shown, or a signal came before begin()
  loading,        ///< the session opens what its options name
  running,        ///< frames come
  ended,          ///< the session is over by itself: its source ended, a signal came, the window did not answer
  failed,         ///< the session is over, by a fault
  restarting,     ///< the session is to end, and another to begin then
  ready,          ///< no session is under way; begin() begins the next
  switching_off,  ///< somebody has switched the run off: the session is silent, but not over yet
  switched_off,   ///< the same, and it is over; nothing but start() begins another
};

class RunControl {
 public:
  /// `kinds` come beside palpa's own. `stop` ends the run and may be set from outside, too; `wake` is called on other
  /// threads when something is new. See LiveSession. Sessions do not give way, whatever the calling thread does later.
  RunControl(LiveSession::Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake);

  RunState state() const { return state_; }
  /// Whether another session follows, without anybody's doing.
  bool restarts() const { return state_ == RunState::restarting || state_ == RunState::ready; }
  /// Whether there is a session whose end advance() has not seen yet.
  bool under_way() const;

  /// The run is to have these options: a session that is under way ends, and another begins. Of a run that is switched
  /// off they are those with which it will start.
  void change(setup::LiveOptions options);
  /// The same, whether it is switched off or not.
  void start(setup::LiveOptions options);
  /// Silence from the next slot on; nothing begins until start(). Whether it was not switched off before.
  bool switch_off();
  /// To be called again and again. For each session once, when it is over: its fault, empty where it did not fail.
  std::optional<std::string> advance();
  /// Begins a session where the state is ready; the one before it is over. Returns a line for each of its outputs that
  /// has another name than the options say (NextOutputs). After a signal (setup::Interrupt) no session begins, and it
  /// returns nothing.
  std::optional<std::vector<std::string>> begin();
  /// Nothing follows: what is ready to begin does not.
  void stay();

  /// Of the session that is there, or was begun last.
  const setup::LiveOptions& options() const { return options_; }
  /// Of the one that begin() begins.
  const setup::LiveOptions& next() const { return next_; }
  /// Until the next one begins; none before the first.
  LiveSession* session() { return session_.get(); }
  const LiveSession* session() const { return session_.get(); }
  /// Whether the session loads, whatever follows it.
  bool loading() const { return session_ && session_->state() == LiveState::loading; }

  /// Whether the session's scene is there, and was not at the last call.
  bool take_scene();
  /// As take_scene() found it; none where it has not yet.
  const std::shared_ptr<const LiveScene>& scene() const { return scene_; }

  /// Silence, and the session's end; false where it is not over within `patience_s`, or loads all the while.
  bool finish(double patience_s);

 private:
  LiveSession::Kinds kinds_;
  std::atomic<bool>* stop_;
  std::function<void()> wake_;
  RunState state_ = RunState::none;
  setup::LiveOptions options_, next_;
  Starter starter_;
  NextOutputs outputs_;
  std::unique_ptr<LiveSession> session_;
  std::shared_ptr<const LiveScene> scene_;
};

}  // namespace palpa::viewer
