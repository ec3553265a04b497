#include "setup/touch_run.hpp"

#include <fmt/core.h>

#include <chrono>

#include "base/error.hpp"
#include "gpu/commands.hpp"
#include "gpu/timestamps.hpp"
#include "touch/stage.hpp"

namespace palpa::setup {
namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

constexpr std::uint32_t most_points_on_gpu = shader::contacts_most_points;
constexpr std::uint32_t most_contacts_on_gpu = 1u << 20;
constexpr std::uint32_t most_deep_on_gpu = 1u << 21;

/// Room for one touch of that input.
touch::Capacity room_for(const TouchInput& input, const touch::Parameters& parameters) {
  if (input.points.size() > most_points_on_gpu) {
    throw bad_usage(
        fmt::format("--points: {} points are more than the {} of one frame on the GPU; --backend cpu takes them",
                    input.points.size(), most_points_on_gpu));
  }
  return {.points = static_cast<std::uint32_t>(input.points.size()),
          .contacts = most_contacts_on_gpu,
          .deep = parameters.wants_deep() ? most_deep_on_gpu : 0};
}

}  // namespace

Stopwatch::Stopwatch() : last_ns_(now_ns()) {}

double Stopwatch::lap_ms() {
  const std::int64_t now = now_ns();
  const std::int64_t elapsed = now - last_ns_;
  last_ns_ = now;
  return static_cast<double>(elapsed) / 1e6;
}

touch::Touch touch_on_cpu(const TouchInput& input, const touch::Parameters& parameters, StageTimes& times) {
  Stopwatch watch;
  touch::HostStage stage(input.solids, input.cameras, parameters);
  touch::check(parameters, stage.solids());
  times.emplace_back("setup", watch.lap_ms());
  touch::Touch out;
  const auto mark = [&](const char* part) { times.emplace_back(part, watch.lap_ms()); };
  if (input.cameras.empty()) {
    stage.touch(input.points, parameters, out, mark);
  } else {
    stage.touch(input.frames, parameters, out, mark);
  }
  return out;
}

touch::Touch touch_on_gpu(const gpu::DeviceOptions& select, const TouchInput& input,
                          const touch::Parameters& parameters, StageTimes& times) {
  Stopwatch watch;
  const touch::Capacity capacity = touch::capacity_for(parameters, room_for(input, parameters));
  const gpu::Device device(select);
  const touch::Stage stage(device, input.solids, input.cameras, parameters);
  touch::check(parameters, stage.solids().host());
  touch::StageFrame frame(device, stage, capacity);
  gpu::Timestamps stamps(device, 16);
  const gpu::Recorder recorder(device, "touch");
  gpu::Timeline timeline(device);
  if (input.cameras.empty()) {
    frame.set(input.points);
  } else {
    frame.set(input.frames);
  }
  times.emplace_back("setup", watch.lap_ms());

  const VkCommandBuffer commands = recorder.begin();
  stamps.begin(commands);
  stage.record(commands, frame, parameters, touch::Detail::contacts, &stamps);
  timeline.wait(timeline.submit(recorder.end()));
  touch::Touch out;
  touch::read(frame, out);
  times.emplace_back("submit to result", watch.lap_ms());
  std::vector<gpu::PassTime> stages;
  stamps.read(stages);
  for (const gpu::PassTime& stage_time : stages)
    times.emplace_back(stage_time.name, stage_time.ms);
  return out;
}

}  // namespace palpa::setup
