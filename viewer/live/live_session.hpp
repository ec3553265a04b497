// The session of `palpa run` on its own threads, with the viewer looking on. Whatever the viewer does, draws or fails
// to do, nothing in the session waits for it. If the viewer stops looking, the session falls silent and ends.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "acoustics/air.hpp"
#include "base/files/outputs.hpp"
#include "sensing/recording.hpp"
#include "session/clock.hpp"
#include "session/loop/run_observer.hpp"
#include "session/newest.hpp"
#include "session/watch/sound_watch.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/near_skin.hpp"
#include "touch/fingers/sight.hpp"
#include "viewer/live/frame_gaps.hpp"
#include "viewer/live/snapshot.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

/// What a session's link was given, and whether it sounds. Written by the session's threads, read by the window's
/// thread.
struct LinkWatch {
  std::atomic<std::uint64_t> drives{0}, silent{0};
  session::SoundWatch sound;

  /// One more drive has left.
  void count(bool sounds, const session::HandOver& counts) {
    sound.sent(sounds, counts.behind);
    ++drives;
    silent += sounds ? 0 : 1;
  }
  /// Nothing leaves any more.
  void close() { sound.close(); }
};

/// What a session uses, once it is loaded.
struct LiveScene {
  Picture picture;                          ///< solids and array; no touch
  std::vector<geometry::SceneMesh> meshes;  ///< of the picture's solids, in their order, for writing them to a file
  std::vector<std::string> solid_names;
  std::vector<sensing::Camera> cameras;
  array::Layout layout;            ///< in the world
  array::DriveOptions drive;       ///< how it is driven
  acoustics::Air air;              ///< in which it sounds
  std::optional<double> spot_m{};  ///< as --spot says
};

enum class LiveState {
  loading,
  running,
  ended,   ///< by the source, by reaching the requested frames, or by all_off()
  failed,  ///< see fault()
};

/// How long the viewer may fail to look before the array falls silent.
struct Patience {
  std::chrono::milliseconds usual{5000};
  /// Applies until it has taken ten snapshots: it is still starting, and drivers compile for each picture that shows
  /// something for the first time. Rounds without a snapshot do not count, because they draw nothing new.
  std::chrono::milliseconds beginning{60000};
  const session::Clock* clock = &session::real_clock();  ///< measures it
};

class LiveSession final : session::RunObserver {
 public:
  /// Kinds of sources and links in addition to palpa's own.
  struct Kinds {
    std::vector<session::SourceKind> sources;
    std::vector<session::LinkKind> links;
    session::OwnMethod method{};  ///< places the foci of every session, instead of --method
  };

  /// Begins to load and then runs. Any thread may set `stop` to end the run. Other threads call `wake` with
  /// each new snapshot; it must not wait. `also` gets each frame that arrives and each plan.
  LiveSession(setup::LiveOptions options, Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake,
              Patience patience = {}, session::RunObserver& also = session::no_observer);
  /// Calls all_off() and waits for the end, also that of loading.
  ~LiveSession() override;
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// Silence from the next slot on, and the end of the run. Only sets a flag, which the output thread checks for every
  /// slot. Neither a full disk nor a GPU that hangs delays it.
  void all_off() { *stop_ = true; }

  /// The largest amplitude that a transducer may have from the next drive on, 0..1, instead of what the options say.
  void set_ceiling(double ceiling) { ceiling_ = ceiling; }

  /// The number of sessions whose run's thread has not finished yet.
  static int under_way() { return under_way_; }

  /// Reports that the viewer is alive. Called once per round of its loop; see Patience.
  void look() { looked_s_ = patience_.clock->now(); }

  LiveState state() const { return state_; }
  /// Whether the run's thread has finished everything.
  bool over() const { return over_; }
  /// Whether the run ended because nobody looked for too long; see Patience.
  bool unattended() const { return unattended_; }
  /// Why it failed; empty if it did not.
  std::string fault() const;
  /// Throws that error again; returns if it did not fail.
  void rethrow() const;
  /// Available once it is loaded; the same object until the end.
  std::shared_ptr<const LiveScene> scene() const;

  /// Whether there is a newer snapshot(); it is valid until the next call.
  bool take() {
    const bool fresh = wants(wants_snapshot_, snapshots_);
    if (fresh) ++taken_;
    return fresh;
  }
  const Snapshot& snapshot() { return snapshots_.front(); }
  /// The same for seen().
  bool take_seen() { return wants(wants_seen_, seen_); }
  const Seen& seen() { return seen_.front(); }

  /// Waits, at most `most_s`, until work of `work_s` delays no frame. Returns how long it waited.
  double let_run(double work_s, double most_s) { return gaps_.wait(work_s, most_s); }

  /// From the next frame on, each pose moves its solid from its place in the scene; see Session::set_pose.
  void place(std::vector<Transform> poses);

  /// The solids that messages (--osc) have moved since the last call, each with its newest pose.
  std::map<std::uint32_t, Transform> take_moved();

  /// From now on, frames are also written to this new folder. Empty: recording ends. An error is logged and ends the
  /// recording.
  void record(const std::string& folder);
  std::string recording() const;  ///< that folder, until its last frame is written or the run has ended
  std::uint64_t recorded() const { return recorded_; }  ///< frames in it, or in the one before

  const LinkWatch& link() const { return link_; }
  /// Complete once the run is over; nullopt if it failed.
  std::optional<session::LoopStats> stats() const;

 private:
  using Clock = std::chrono::steady_clock;
  template <typename T>
  static bool wants(std::atomic<bool>& flag, session::Newest<T>& values) {
    const bool fresh = values.take();
    flag = true;
    return fresh;
  }
  void work();
  void publish_scene(setup::LiveRun& run);
  void arrived(std::uint64_t sequence) override {
    gaps_.arrived(sequence);
    also_->arrived(sequence);
  }
  void planned(const session::FrameReport& report, const session::Plan& plan) override;
  void sent(bool sounds, const session::HandOver& counts) override { link_.count(sounds, counts); }
  void moved(std::uint32_t solid, const Transform& T_world_rest) override;
  void publish_snapshot(const session::FrameReport& report, const session::Plan& plan);
  void saw(const sensing::FrameSet& set);
  void count(const session::FrameReport& report);
  void write_down(const sensing::FrameSet& set);
  void close_recorder();
  void follow_poses(session::Session& session);
  void look_around();

  inline static std::atomic<int> under_way_{0};
  setup::LiveOptions options_;
  Kinds kinds_;
  std::atomic<bool>* stop_;
  std::atomic<double> ceiling_;
  std::function<void()> wake_;
  Patience patience_;
  session::RunObserver* also_;
  std::atomic<LiveState> state_{LiveState::loading};
  std::atomic<bool> over_{false};
  std::atomic<bool> unattended_{false};
  std::atomic<bool> touches_{false};                      ///< a finger touches in the newest frame
  std::atomic<double> looked_s_{patience_.clock->now()};  ///< or when it was constructed
  std::atomic<std::uint64_t> taken_{0};                   ///< snapshots
  std::atomic<bool> wants_snapshot_{true}, wants_seen_{true};
  session::Newest<Snapshot> snapshots_;
  session::Newest<Seen> seen_;
  LinkWatch link_;
  FrameGaps gaps_;
  LiveNumbers numbers_;                  ///< of the compute thread
  session::Session* session_ = nullptr;  ///< while it runs
  std::uint64_t placed_ = 0;             ///< the number of the poses that it has
  std::optional<std::uint64_t> last_sequence_;
  Clock::time_point last_frame_{};
  // For the recorder's thread; made before it begins.
  std::uint64_t looked_around_ = 0;
  std::optional<setup::NearSkin> near_;
  std::vector<touch::SightCamera> sight_;
  bool modest_ = false;
  std::optional<Outputs> record_outputs_;  ///< what the recorder writes
  std::optional<sensing::RecordingWriter> recorder_;
  std::uint64_t recordings_seen_ = 0;
  std::atomic<std::uint64_t> placements_{0}, recordings_{0}, recorded_{0};
  mutable std::mutex mutex_;
  std::vector<Transform> poses_;
  std::map<std::uint32_t, Transform> moved_;
  std::string record_to_, recording_;
  std::string fault_;
  std::exception_ptr error_;
  std::shared_ptr<const LiveScene> scene_;
  std::optional<session::LoopStats> stats_;
  std::thread thread_;
};

}  // namespace palpa::viewer
