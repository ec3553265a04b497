#include "session/toucher.hpp"

#include <utility>

#include "base/error.hpp"
#include "gpu/commands.hpp"
#include "session/chain.hpp"
#include "session/overrides.hpp"
#include "touch/host_stage.hpp"
#include "touch/stage.hpp"

namespace palpa::session {
namespace {

/// Skin to fingers, wherever it is computed.
class Backend {
 public:
  virtual ~Backend() = default;
  virtual void touch(std::span<const sensing::SkinPoint> skin, double time_s, touch::Touch& out) = 0;
  virtual void touch(std::span<const sensing::DepthFrame> images, double time_s, touch::Touch& out) = 0;
  virtual void set_pose(std::uint32_t solid, const Transform& T_world_rest) = 0;
};

class CpuBackend : public Backend {
 public:
  CpuBackend(const std::vector<geometry::Solid>& solids, const ToucherOptions& options)
      : stage_(solids, options.cameras, {.parameters = options.touch, .follow = true}) {}
  void touch(std::span<const sensing::SkinPoint> skin, double time_s, touch::Touch& out) override {
    stage_.touch(skin, out, time_s);
  }
  void touch(std::span<const sensing::DepthFrame> images, double time_s, touch::Touch& out) override {
    stage_.touch(images, out, time_s);
  }
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) override { stage_.set_pose(solid, T_world_rest); }

 private:
  touch::HostStage stage_;
};

class GpuBackend : public Backend {
 public:
  GpuBackend(const gpu::Device& device, const std::vector<geometry::Solid>& solids, const ToucherOptions& options)
      : passes_(device),
        stage_(passes_, solids, options.cameras, {.parameters = options.touch, .follow = true}),
        memory_(stage_),
        recorder_(device, "touch"),
        timeline_(device, "touch") {}
  void touch(std::span<const sensing::SkinPoint> skin, double time_s, touch::Touch& out) override {
    memory_.set(skin);
    run(time_s, out);
  }
  void touch(std::span<const sensing::DepthFrame> images, double time_s, touch::Touch& out) override {
    memory_.set(images);
    run(time_s, out);
  }
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) override { stage_.set_pose(solid, T_world_rest); }

 private:
  void run(double time_s, touch::Touch& out) {
    stage_.record(recorder_.begin(), memory_, time_s);
    timeline_.wait(timeline_.submit(recorder_.end()));
    touch::read(memory_, out);
  }

  touch::Passes passes_;
  touch::Stage stage_;
  touch::StageMemory memory_;
  gpu::Recorder recorder_;
  gpu::Timeline timeline_;
};

}  // namespace

struct Toucher::State {
  std::vector<geometry::Solid> solids;
  ToucherOptions options;
  std::unique_ptr<Backend> backend;
  EventTracker tracker;
  std::vector<sensing::SkinPoint> skin;
  touch::Touch touch;
  std::span<const Event> events;
  ScheduleMemory memory;
  array::Schedule schedule;
  double slot_s = 0;

  State(const gpu::Device* device, std::vector<geometry::Solid> given, const ToucherOptions& chosen)
      : solids(std::move(given)), options(chosen), tracker(solids, options.events) {
    options.touch.deep = true;
    check_overrides("scene", solids, options.touch, options.voice);
    array::fill_order(options.touch.foci, options.voice.stride);  // throws where the two do not go together
    if (device) {
      backend = std::make_unique<GpuBackend>(*device, solids, options);
    } else {
      backend = std::make_unique<CpuBackend>(solids, options);
    }
    slot_s = slot_length(solids, options.voice);
  }

  /// All that follows once the fingers are known.
  const touch::Touch& finish(double time_s) {
    events = tracker.update(touch, time_s);
    make_schedule(touch, time_s, solids, {options.method, options.voice, options.tune}, slot_s, memory, schedule);
    return touch;
  }
};

Toucher::Toucher(std::vector<geometry::Solid> solids, const ToucherOptions& options)
    : state_(std::make_unique<State>(nullptr, std::move(solids), options)) {}
Toucher::Toucher(const gpu::Device& device, std::vector<geometry::Solid> solids, const ToucherOptions& options)
    : state_(std::make_unique<State>(&device, std::move(solids), options)) {}
Toucher::~Toucher() = default;
Toucher::Toucher(Toucher&&) noexcept = default;
Toucher& Toucher::operator=(Toucher&&) noexcept = default;

const touch::Touch& Toucher::touch(std::span<const sensing::DepthFrame> images, double time_s) {
  State& s = *state_;
  if (s.options.cameras.empty()) throw bad_usage("a Toucher without cameras touches skin points, not depth frames");
  s.backend->touch(images, time_s, s.touch);
  return s.finish(time_s);
}

const touch::Touch& Toucher::touch(std::span<const glm::vec3> skin, double time_s) {
  State& s = *state_;
  s.skin.resize(skin.size());
  for (std::size_t i = 0; i < skin.size(); ++i)
    s.skin[i] = {skin[i], static_cast<std::uint32_t>(i)};
  return touch(s.skin, time_s);
}

const touch::Touch& Toucher::touch(std::span<const sensing::SkinPoint> skin, double time_s) {
  State& s = *state_;
  if (!s.options.cameras.empty()) throw bad_usage("a Toucher with cameras touches depth frames, not skin points");
  s.backend->touch(skin, time_s, s.touch);
  return s.finish(time_s);
}

void Toucher::set_pose(std::uint32_t solid, const Transform& T_world_rest) {
  state_->backend->set_pose(solid, T_world_rest);
}

std::span<const Event> Toucher::events() const {
  return state_->events;
}

const array::Schedule& Toucher::schedule() const {
  return state_->schedule;
}

std::span<const Event> Toucher::end() {
  return state_->events = state_->tracker.end();
}

const std::vector<geometry::Solid>& Toucher::solids() const {
  return state_->solids;
}

}  // namespace palpa::session
