#include "cli/touch_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"
#include "gpu/timestamps.hpp"
#include "session/chain.hpp"
#include "touch/chain.hpp"

namespace palpa::cli {
namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Skin points in device memory, and how many: from a file they are uploaded, from depth images passes find them.
class SkinOnGpu {
 public:
  SkinOnGpu(const gpu::Device& device, const TouchInput& input, const Box& reach);

  void record(VkCommandBuffer commands, gpu::Timestamps& times);
  gpu::BufferRef points() const { return memory_ ? memory_->points.ref() : points_.ref(); }
  gpu::BufferRef total() const { return memory_ ? memory_->total.ref() : total_.ref(); }
  std::uint32_t most() const { return most_; }

 private:
  void upload_points(const gpu::Device& device, const TouchInput& input);
  void upload_depths(const gpu::Device& device, const TouchInput& input);

  Box reach_;
  std::uint32_t most_ = 0;
  gpu::Upload points_, total_;
  // Only with depth images:
  sensing::RayTables tables_;
  std::vector<sensing::View> views_;
  gpu::Upload depth_;
  gpu::Buffer rays_;
  std::optional<sensing::SkinMemory> memory_;
  std::optional<sensing::SkinPass> pass_;
};

constexpr std::uint32_t most_points_on_gpu = shader::contacts_most_points;
constexpr std::uint32_t most_contacts_on_gpu = 1u << 20;

SkinOnGpu::SkinOnGpu(const gpu::Device& device, const TouchInput& input, const Box& reach) : reach_(reach) {
  if (input.cameras.empty()) {
    upload_points(device, input);
  } else {
    upload_depths(device, input);
  }
}

void SkinOnGpu::upload_points(const gpu::Device& device, const TouchInput& input) {
  if (input.points.size() > most_points_on_gpu) {
    throw bad_usage(
        fmt::format("--points: {} points are more than the {} of one frame on the GPU; --backend cpu takes them",
                    input.points.size(), most_points_on_gpu));
  }
  static_assert(sizeof(sensing::SkinPoint) == 16);
  most_ = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(input.points.size()));
  points_ = gpu::Upload(device, std::uint64_t{most_} * sizeof(sensing::SkinPoint), "skin points");
  if (!input.points.empty()) {
    std::memcpy(points_.data(), input.points.data(), input.points.size() * sizeof(sensing::SkinPoint));
  }
  total_ = gpu::Upload(device, sizeof(shader::ScanTotal), "skin total");
  const auto count = static_cast<std::uint32_t>(input.points.size());
  total_.as<shader::ScanTotal>()[0] = {count, gpu::groups_for(count, 64), 1, 1};
}

void SkinOnGpu::upload_depths(const gpu::Device& device, const TouchInput& input) {
  tables_ = sensing::make_rays(input.cameras);
  sensing::plan_views(input.cameras, tables_, reach_, views_);
  most_ = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(tables_.pixels, 1, most_points_on_gpu));
  depth_ = gpu::Upload(device, sensing::packed_bytes(tables_), "depth frames");
  sensing::pack_depth(tables_, input.frames, depth_.as<std::uint16_t>());
  rays_ = sensing::upload_rays(device, tables_);
  memory_.emplace(device, tables_);
  pass_.emplace(device);
}

void SkinOnGpu::record(VkCommandBuffer commands, gpu::Timestamps& times) {
  if (!memory_) {
    points_.record(commands);
    total_.record(commands);
    return;
  }
  depth_.record(commands);
  pass_->record(commands, memory_->with(depth_.ref(), rays_.ref()), tables_, reach_, views_, &times);
  gpu::compute_to_compute(commands);
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
  const touch::PlaneTable table = touch::make_plane_table(input.solids);
  touch::check(parameters, table);
  times.emplace_back("setup", watch.lap_ms());
  std::vector<sensing::SkinPoint> seen;
  if (!input.cameras.empty()) {
    seen = sensing::find_skin(input.cameras, input.frames, session::touchable_box(input.solids));
    times.emplace_back("skin", watch.lap_ms());
  }
  touch::Touch out;
  touch::find_contacts(input.cameras.empty() ? input.points : seen, table, parameters.delta_m, out.contacts);
  times.emplace_back("contacts", watch.lap_ms());
  touch::find_fingers(parameters, table, out);
  times.emplace_back("fingers", watch.lap_ms());
  touch::find_sections(parameters, out);
  times.emplace_back("foci", watch.lap_ms());
  return out;
}

touch::Touch touch_on_gpu(const gpu::DeviceOptions& select, const TouchInput& input,
                          const touch::Parameters& parameters, StageTimes& times) {
  Stopwatch watch;
  const gpu::Device device(select);
  const touch::SolidTable table(device, input.solids);
  touch::check(parameters, table.host());
  SkinOnGpu skin(device, input, session::touchable_box(input.solids));
  touch::TouchBuffers buffers(device, {skin.most(), std::min(skin.most(), most_contacts_on_gpu)});
  const touch::TouchPasses passes(device);
  gpu::Timestamps stamps(device, 16);
  const gpu::Recorder recorder(device, "touch");
  gpu::Timeline timeline(device);
  times.emplace_back("setup", watch.lap_ms());

  const VkCommandBuffer commands = recorder.begin();
  stamps.begin(commands);
  skin.record(commands, stamps);
  passes.record(commands, table, buffers, skin.points(), skin.total(), parameters, &stamps);
  timeline.wait(timeline.submit(recorder.end()));
  touch::Touch out;
  touch::read(buffers, out);
  times.emplace_back("submit to result", watch.lap_ms());
  std::vector<gpu::PassTime> stages;
  stamps.read(stages);
  for (const gpu::PassTime& stage : stages)
    times.emplace_back(stage.name, stage.ms);
  return out;
}

}  // namespace palpa::cli
