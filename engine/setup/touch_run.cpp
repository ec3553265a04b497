#include "setup/touch_run.hpp"

#include <fmt/core.h>

#include <chrono>

#include "base/error.hpp"
#include "gpu/commands.hpp"
#include "gpu/timestamps.hpp"
#include "shaders/contacts.h"
#include "touch/host_stage.hpp"
#include "touch/stage.hpp"

namespace palpa::setup {
namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// One touch alone may be of a whole plate: room for more contacts than a frame of a loop has.
constexpr std::uint32_t most_contacts_on_gpu = 1U << 20;

void check_points(const TouchInput& input) {
  if (input.points.size() > shader::contacts_most_points) {
    throw bad_usage(
        fmt::format("--points: {} points are more than the {} of one frame on the GPU; --backend cpu takes them",
                    input.points.size(), shader::contacts_most_points));
  }
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
  touch::HostStage stage(input.solids, input.cameras, {.parameters = parameters});
  times.emplace_back("setup", watch.lap_ms());
  touch::Touch out;
  const auto mark = [&](const char* part) { times.emplace_back(part, watch.lap_ms()); };
  if (input.cameras.empty()) {
    stage.touch(input.points, out, 0, mark);
  } else {
    stage.touch(input.frames, out, 0, mark);
  }
  return out;
}

touch::Touch touch_on_gpu(const gpu::DeviceOptions& select, const TouchInput& input,
                          const touch::Parameters& parameters, StageTimes& times) {
  Stopwatch watch;
  check_points(input);
  const gpu::Device device(select);
  touch::Passes passes(device);
  touch::Stage stage(passes, input.solids, input.cameras,
                     {.parameters = parameters, .most_contacts = input.cameras.empty() ? 0 : most_contacts_on_gpu});
  touch::StageMemory memory(stage);
  gpu::Timestamps stamps(device, 16);
  const gpu::Recorder recorder(device, "touch");
  gpu::Timeline timeline(device);
  if (input.cameras.empty()) {
    memory.set(input.points);
  } else {
    memory.set(input.frames);
  }
  times.emplace_back("setup", watch.lap_ms());

  const VkCommandBuffer commands = recorder.begin();
  stamps.begin(commands);
  stage.record(commands, memory, 0, &stamps);
  timeline.wait(timeline.submit(recorder.end()));
  touch::Touch out;
  touch::read(memory, out);
  times.emplace_back("submit to result", watch.lap_ms());
  std::vector<gpu::PassTime> stages;
  stamps.read(stages);
  for (const gpu::PassTime& stage_time : stages)
    times.emplace_back(stage_time.name, stage_time.ms);
  return out;
}

}  // namespace palpa::setup
