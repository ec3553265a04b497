#include "setup/sessions/scene_reload.hpp"

#include <fmt/core.h>
#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <utility>

#include "base/activity.hpp"
#include "base/log.hpp"
#include "session/threads.hpp"

namespace palpa::setup {
namespace {

constexpr double between_looks_s = 0.1;

std::array<std::uint64_t, 4> state_of(const std::string& file) {
  struct stat is {};
  if (::stat(file.c_str(), &is) != 0) return {};
  return {is.st_ino, static_cast<std::uint64_t>(is.st_size), static_cast<std::uint64_t>(is.st_mtim.tv_sec),
          static_cast<std::uint64_t>(is.st_mtim.tv_nsec)};
}

}  // namespace

SceneState look_at_scene(const std::string& file) {
  const std::filesystem::path path(file);
  if (path.extension() != ".gltf") return {state_of(file), {}};
  return {state_of(file), state_of(std::filesystem::path(path).replace_extension(".bin").string())};
}

SceneReload::SceneReload(std::string file, const SceneState& runs, Load load, const session::Clock& clock)
    : clock_(&clock), file_(std::move(file)), read_at_(runs), load_(std::move(load)) {
  thread_ = clock.start("--reload", [this] { work(); });
}

SceneReload::~SceneReload() {
  stop();
}

void SceneReload::take(session::Session& running) {
  const std::lock_guard lock(mutex_);  // nobody holds it for longer than a move
  running.exchange_scene(*next_);
  ready_ = false;
  ++taken_;
}

void SceneReload::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  clock_->wake(wake_);
  clock_->join(thread_);
}

session::ReloadStats SceneReload::end() {
  stop();
  return {.taken = taken_, .refused = refused_};
}

void SceneReload::work() {
  session::take_no_signals();
  session::give_way();
  const Cancellable cancellable(ends_);
  SceneState seen = read_at_;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      if (clock_->wait(wake_, lock, between_looks_s, [this] { return ends_.load(); })) return;
    }
    put_away(nullptr);
    // A file that is being written is another one at the next look.
    const SceneState now = look_at_scene(file_);
    if (std::exchange(seen, now) != now || now == read_at_) continue;
    read_at_ = now;
    try {
      read();
    } catch (const std::exception& error) {
      if (ends_) return;
      if (look_at_scene(file_) != now) continue;  // it is being written, and will be read again
      ++refused_;
      log::warning(fmt::format("--reload: palpa keeps the previous scene: {}", error.what()));
    }
  }
}

void SceneReload::read() {
  std::unique_ptr<session::Session> other = load_();
  bool waited = false;
  {
    const std::lock_guard lock(mutex_);
    std::swap(next_, other);
    waited = ready_.exchange(true);
  }
  if (!waited) put_away(std::move(other));
  log::info(fmt::format("--reload: {} was read again", file_));
}

/// Ends a scene that ran before: `old`, or the one that take() has left. This takes a while.
void SceneReload::put_away(std::unique_ptr<session::Session> old) {
  if (!old) {
    const std::lock_guard lock(mutex_);
    if (!ready_) old = std::move(next_);
  }
  if (!first_) first_ = std::move(old);
}

}  // namespace palpa::setup
