#include "viewer/live/live_session.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/system/start_thread.hpp"
#include "session/threads.hpp"

namespace palpa::viewer {
namespace {

/// Snapshots with which the viewer is still starting (Patience).
constexpr std::uint64_t first_snapshots = 10;

/// About how long finding the skin takes, and how long that may wait for the run.
constexpr double skin_s = 3e-3, most_wait_s = 0.05;

}  // namespace

LiveSession::LiveSession(setup::LiveOptions options, Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake,
                         Patience patience, session::RunObserver& also)
    : options_(std::move(options)),
      kinds_(std::move(kinds)),
      stop_(&stop),
      ceiling_(options_.safety.ceiling),
      wake_(std::move(wake)),
      patience_(patience),
      also_(&also) {
  options_.watched = true;
  if (kinds_.method) options_.own_method = kinds_.method;
  options_.safety.ceiling_now = &ceiling_;
  ++under_way_;
  try {
    thread_ = start_thread("a live run", [this] { work(); });
  } catch (...) {
    --under_way_;
    throw;
  }
}

LiveSession::~LiveSession() {
  all_off();
  if (thread_.joinable()) thread_.join();
}

void LiveSession::work() {
  LiveState end = LiveState::ended;
  std::string fault;
  std::exception_ptr thrown;
  std::optional<session::LoopStats> stats;
  try {
    const Outputs outputs(setup::outputs_of(options_, setup::with_builtin(kinds_.links)));
    setup::LiveRun run(options_, kinds_.sources, kinds_.links, *stop_);
    publish_scene(run);
    session_ = &run.session();
    follow_poses(run.session());
    log::release_warnings();
    state_ = LiveState::running;
    wake_();
    stats = run.run(*this, [this](const sensing::FrameSet& set) { saw(set); });
  } catch (const WaitEnded&) {
    // The run's pipe had found no reader before the user ended the run.
  } catch (const std::exception& error) {
    end = LiveState::failed;
    fault = error.what();
    thrown = std::current_exception();
  }
  link_.close();
  gaps_.over();
  close_recorder();  // however the run ended, its recording is complete
  {
    const std::lock_guard lock(mutex_);
    recording_.clear();
    fault_ = std::move(fault);
    error_ = std::move(thrown);
    stats_ = std::move(stats);
  }
  state_ = end;
  over_ = true;
  --under_way_;
  wake_();
}

void LiveSession::publish_scene(setup::LiveRun& run) {
  auto scene = std::make_shared<LiveScene>();
  show_solids(scene->picture, run.session().solids());
  show_array(scene->picture, run.session().setting().layout);
  show_cameras(scene->picture, run.source().cameras());
  for (const geometry::Solid& solid : run.session().solids()) {
    const auto& parts = solid.parts.parts;
    if (parts.size() < 2) scene->meshes.push_back({solid.name, solid.mesh, solid.haptics, {}, {}});
    const auto group = static_cast<std::uint32_t>(&solid - run.session().solids().data());
    for (std::size_t i = 0; parts.size() > 1 && i < parts.size(); ++i)
      scene->meshes.push_back(
          {solid.name, parts[i].mesh, solid.haptics, geometry::PartOf{solid.name, group, solid.parts.seam_m}, {}});
  }
  scene->solid_names = run.session().solid_names();
  scene->cameras = run.source().cameras();
  scene->layout = run.session().setting().layout;
  scene->drive = run.session().setting().drive;
  scene->air = setup::air(options_.drive.medium, {});
  scene->spot_m = run.session().setting().schedule.spot_m;
  near_.emplace(run.session().setting());
  sight_ = touch::sight_cameras(run.session().setting().cameras, near_->rays());
  look_around();
  const std::lock_guard lock(mutex_);
  scene_ = std::move(scene);
}

void LiveSession::place(std::vector<Transform> poses) {
  const std::lock_guard lock(mutex_);
  poses_ = std::move(poses);
  ++placements_;
}

void LiveSession::record(const std::string& folder) {
  const std::lock_guard lock(mutex_);
  record_to_ = folder;
  ++recordings_;
}

std::string LiveSession::recording() const {
  const std::lock_guard lock(mutex_);
  return recording_;
}

void LiveSession::write_down(const sensing::FrameSet& set) {
  try {
    if (recordings_seen_ != recordings_) {
      std::string folder;
      {
        const std::lock_guard lock(mutex_);
        recordings_seen_ = recordings_;
        folder = record_to_;
        recording_.clear();
      }
      // A slow disk holds up nothing else.
      close_recorder();
      if (!folder.empty()) {
        recorded_ = 0;
        record_outputs_.emplace(std::vector<Output>{{"record", folder, Output::Kind::folder}});
        recorder_.emplace(folder, session_->setting().cameras);
      }
      const std::lock_guard lock(mutex_);
      recording_ = folder;
    }
    if (!recorder_) return;
    recorder_->write(set);
    recorded_ = recorder_->frames();
  } catch (const Error& error) {
    log::error(error.what());
    recorder_.reset();
    const std::lock_guard lock(mutex_);
    record_to_.clear();
    recording_.clear();
  }
}

// On the recorder's thread, or after it.
void LiveSession::close_recorder() {
  if (recorder_) recorder_->discard();  // a recording without a frame leaves nothing behind
  recorder_.reset();
  record_outputs_.reset();
}

// On the compute thread, or before there is one.
void LiveSession::follow_poses(session::Session& session) {
  if (placements_ == placed_) return;
  const std::lock_guard lock(mutex_);
  placed_ = placements_;
  for (std::uint32_t i = 0; i < std::min(poses_.size(), session.solids().size()); ++i)
    session.set_pose(i, poses_[i]);
}

// On the compute thread.
void LiveSession::moved(std::uint32_t solid, const Transform& T_world_rest) {
  const bool followed = placed_ == placements_;
  const std::lock_guard lock(mutex_);
  poses_.resize(std::max(poses_.size(), std::size_t{solid} + 1), Transform(1.0));
  poses_[solid] = moved_[solid] = T_world_rest;
  const std::uint64_t now = ++placements_;
  if (followed && now == placed_ + 1) placed_ = now;  // the session has it
}

std::map<std::uint32_t, Transform> LiveSession::take_moved() {
  const std::lock_guard lock(mutex_);
  return std::exchange(moved_, {});
}

// On the recorder's thread, or before there is one.
void LiveSession::look_around() {
  std::vector<Transform> poses;
  {
    const std::lock_guard lock(mutex_);
    looked_around_ = placements_;
    poses = poses_;
  }
  near_->place(std::move(poses));
}

std::string LiveSession::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

void LiveSession::rethrow() const {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
}

std::shared_ptr<const LiveScene> LiveSession::scene() const {
  const std::lock_guard lock(mutex_);
  return scene_;
}

std::optional<session::LoopStats> LiveSession::stats() const {
  const std::lock_guard lock(mutex_);
  return stats_;
}

void LiveSession::count(const session::FrameReport& report) {
  constexpr double weight = 1.0 / 50;
  const Clock::time_point now = Clock::now();
  LiveNumbers& n = numbers_;
  if (last_sequence_ && report.sequence > *last_sequence_ + 1) n.dropped += report.sequence - *last_sequence_ - 1;
  if (last_sequence_) {
    const double apart = std::max(std::chrono::duration<double>(now - last_frame_).count(), 1e-6);
    n.rate_hz = n.rate_hz > 0 ? 1 / ((1 - weight) / n.rate_hz + weight * apart) : 1 / apart;
  }
  last_sequence_ = report.sequence;
  last_frame_ = now;
  ++n.frames;
  n.touching += report.touch->finger_count > 0 ? 1 : 0;
  n.thinned += report.effort.whole() ? 0 : 1;
  n.outdated += report.outdated ? 1 : 0;
  n.last_s = report.planned_s - report.arrived_s;
  n.bins.add(n.last_s);
  for (const gpu::PassTime& pass : report.passes) {
    auto at = std::ranges::find(n.passes, pass.name, &PassTimes::name);
    if (at == n.passes.end()) {
      n.passes.push_back({pass.name, pass.ms});
      continue;
    }
    at->mean_ms += weight * (pass.ms - at->mean_ms);
  }
}

// On the compute thread.
void LiveSession::planned(const session::FrameReport& report, const session::Plan& plan) {
  also_->planned(report, plan);
  count(report);
  touches_ = report.touch->finger_count > 0;
  follow_poses(*session_);
  const std::chrono::duration<double> unseen(patience_.clock->now() - looked_s_);
  const std::chrono::milliseconds patience = taken_ < first_snapshots ? patience_.beginning : patience_.usual;
  if (unseen > patience && !stop_->exchange(true)) {
    unattended_ = true;
    log::warning(fmt::format("the window has not answered for {} s: the run ends",
                             std::chrono::duration_cast<std::chrono::seconds>(patience).count()));
  }
  if (wants_snapshot_.exchange(false)) publish_snapshot(report, plan);
  gaps_.planned(report.sequence);
}

void LiveSession::publish_snapshot(const session::FrameReport& report, const session::Plan& plan) {
  Snapshot& next = snapshots_.back();
  next.sequence = report.sequence;
  next.time_s = report.time_s;
  next.touch = *report.touch;
  next.plan = plan;
  next.numbers = numbers_;
  snapshots_.publish();
  wake_();
}

// On a thread that nothing waits for, unless every frame is looked at.
void LiveSession::saw(const sensing::FrameSet& set) {
  if (!std::exchange(modest_, true) && options_.record.empty()) session::give_way();
  write_down(set);
  if (!wants_seen_.exchange(false)) return;
  if (!recorder_ && options_.record.empty() && !options_.every_frame) gaps_.wait(skin_s, most_wait_s);
  if (looked_around_ != placements_) look_around();
  Seen& next = seen_.back();
  next.sequence = set.sequence;
  next.images = set;
  next.skin.wants_leavings = true;
  near_->find(set, next.skin);
  if (!set.frames.empty())
    touch::part_flying({sight_, near_->rays(), set.frames}, next.skin.points, next.skin.leavings);
  next.untouched.clear();
  if (!touches_) next.untouched = setup::why_untouched(near_->nearest(next.skin.points), session_->solids());
  seen_.publish();
  wake_();
}

}  // namespace palpa::viewer
