// `--osc`: messages of Open Sound Control by UDP change a running session (docs/live-control.md). A thread of its own
// receives them. The loop takes the newest values, and waits for nobody.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <thread>

#include "base/sparing.hpp"
#include "base/system/udp.hpp"
#include "session/control/live_values.hpp"
#include "session/loop/run_options.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

/// The address of "PORT" or "ADDRESS:PORT": of this machine alone if there is only a port. Throws bad_usage for another
/// form.
NetAddress parse_osc_address(const std::string& text);

/// Give it to the run as RunOptions::changes, and to the session its gain as Safety::gain_now, and feel_may_change.
class Osc final : public RunChanges {
 public:
  /// Opens the socket. Messages wait there until listen(). Throws as parse_osc_address and UdpReceiver do, and
  /// bad_usage without liblo.
  explicit Osc(const std::string& address);
  ~Osc() override;
  Osc(const Osc&) = delete;
  Osc& operator=(const Osc&) = delete;

  const std::atomic<double>& gain() const { return values_.factor(); }
  /// Messages count from now on, and `observer`, which must outlive the run, hears of solids that move.
  void listen(const Session& session, RunObserver& observer);
  /// The same for a run without a scene: gain and mute.
  void listen();
  /// The scene was replaced. To be called from RunChanges::take_scene.
  void set_scene(const Session& session) { values_.set_scene(session); }
  void before_frame(Session& session) override { values_.apply(session, *observer_); }

  /// No message counts any more. If several were refused, logs how many.
  MessageStats end();

 private:
  void work();
  void take(std::span<char> packet, int depth = 0);
  void take_message(std::span<char> bytes);
  void refuse(const std::string& why);

  std::string name_;
  UdpReceiver socket_;
  LiveValues values_;
  RunObserver* observer_ = &no_observer;
  MessageStats stats_;  ///< the thread's
  Sparing reasons_;     ///< the thread's
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace palpa::session
