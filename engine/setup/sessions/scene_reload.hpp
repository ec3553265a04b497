// `palpa run --reload`: the scene is read again when its file has been saved, and replaces the one that runs between
// two frames. A separate thread looks at the file and reads it. A scene that cannot be used changes nothing. Each
// is a warning: somebody has saved it and waits for it.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "session/clock.hpp"
#include "session/session.hpp"
#include "session/watch/stats.hpp"

namespace palpa::setup {

/// What changes when a scene is saved: number, size and time of its file and, for a .gltf, of the file beside it into
/// which Blender writes the meshes. All 0: there is no such file.
using SceneState = std::array<std::array<std::uint64_t, 4>, 2>;
SceneState look_at_scene(const std::string& file);

class SceneReload {
 public:
  /// Makes a session of the scene as it is in the file now. Throws Error.
  using Load = std::function<std::unique_ptr<session::Session>()>;
  /// `runs`: the state of the file before the scene that runs was read from it.
  SceneReload(std::string file, const SceneState& runs, Load load, const session::Clock& clock = session::real_clock());
  ~SceneReload();
  SceneReload(const SceneReload&) = delete;
  SceneReload& operator=(const SceneReload&) = delete;

  /// Whether a scene waits for take(). The loop's thread calls both.
  bool ready() const { return ready_; }
  /// Exchanges the scene that runs.
  void take(session::Session& running);
  /// How many scenes could not be used so far.
  std::uint64_t refused() const { return refused_; }

  /// No scene comes any more. The scene of the beginning stays until this object ends: the link has values of it.
  session::ReloadStats end();

 private:
  void stop();
  void work();
  void read();
  void put_away(std::unique_ptr<session::Session> old);

  const session::Clock* clock_;
  std::string file_;
  SceneState read_at_;
  Load load_;
  std::atomic<bool> ready_{false};
  std::mutex mutex_;
  std::condition_variable wake_;
  std::unique_ptr<session::Session> next_;   ///< one that waits, or after take() the one before
  std::unique_ptr<session::Session> first_;  ///< the thread's: the scene of the beginning
  std::uint64_t taken_ = 0;                  ///< the loop's
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace palpa::setup
