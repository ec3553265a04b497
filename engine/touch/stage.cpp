#include "touch/stage.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"

namespace palpa::touch {
namespace {

Capacity with_pixels(Capacity capacity, const sensing::RayTables& tables, bool deep) {
  constexpr std::uint32_t some = 65'536;
  if (deep && capacity.deep == 0) capacity.deep = some;
  if (tables.pixels != 0) {
    capacity.points = static_cast<std::uint32_t>(std::min<std::uint64_t>(tables.pixels, shader::contacts_most_points));
  }
  return capacity;
}

gpu::Upload upload_cameras(const gpu::Device& device, const std::vector<shader::BridgeCamera>& cameras) {
  gpu::Upload upload(device, cameras.size() * sizeof(shader::BridgeCamera), "bridge cameras");
  if (cameras.empty()) return upload;
  std::memcpy(upload.data(), cameras.data(), cameras.size() * sizeof(shader::BridgeCamera));
  const gpu::Recorder recorder(device, "bridge cameras");
  gpu::Timeline timeline(device, "bridge cameras");
  upload.record(recorder.begin());
  timeline.wait(timeline.submit(recorder.end()));
  return upload;
}

}  // namespace

Stage::Stage(const gpu::Device& device, const std::vector<geometry::Solid>& solids,
             std::span<const sensing::Camera> cameras, const Parameters& parameters)
    : cameras_(cameras.begin(), cameras.end()),
      tables_(sensing::make_rays(cameras)),
      rays_(sensing::upload_rays(device, tables_)),
      bridge_cameras_(upload_cameras(device, bridge_cameras(cameras, tables_))),
      deep_(parameters.wants_deep()),
      solids_(device, solids, parameters),
      skin_pass_(device),
      touch_passes_(device) {}

void Stage::record(VkCommandBuffer commands, StageFrame& frame, const Parameters& parameters, Detail detail,
                   gpu::Timestamps* times, const Following& following) const {
  if (!frame.skin_) {
    frame.points_.record(commands);
    frame.total_.record(commands);
    touch_passes_.record(commands, solids_, frame.touch_, frame.points_.ref(), frame.total_.ref(), parameters, times,
                         detail, nullptr, following);
    return;
  }
  frame.depth_.record(commands);
  const Box box = solids_.box();
  sensing::plan_views(cameras_, tables_, box, frame.views_);
  const sensing::SkinBuffers skin = frame.skin_->with(frame.depth_.ref(), rays_.ref());
  skin_pass_.record(commands, skin, tables_, box, frame.views_, times);
  gpu::compute_to_compute(commands);
  const SightBuffers sight{frame.depth_.ref(), rays_.ref(), bridge_cameras_.ref()};
  touch_passes_.record(commands, solids_, frame.touch_, skin.points, skin.total, parameters, times, detail, &sight,
                       following);
}

StageFrame::StageFrame(const gpu::Device& device, const Stage& stage, Capacity capacity)
    : tables_(&stage.tables_), touch_(device, with_pixels(capacity, stage.tables_, stage.deep_)) {
  if (stage.tables_.pixels != 0) {
    views_.reserve(stage.cameras_.size());
    depth_ = gpu::Upload(device, sensing::packed_bytes(stage.tables_), "depth frames");
    skin_.emplace(device, stage.tables_);
    return;
  }
  static_assert(sizeof(sensing::SkinPoint) == 16, "a skin point is one vec4 on the device");
  points_ = gpu::Upload(device, std::uint64_t{touch_.capacity().points} * sizeof(sensing::SkinPoint), "skin points");
  total_ = gpu::Upload(device, sizeof(shader::ScanTotal), "skin total");
}

void StageFrame::set(std::span<const sensing::DepthFrame> images) {
  sensing::pack_depth(*tables_, images, depth_.as<std::uint16_t>());
}

void StageFrame::set(std::span<const sensing::SkinPoint> points) {
  if (skin_ || points.size() > touch_.capacity().points) {
    throw bad_usage(fmt::format("{} skin points for a frame with room for {}", points.size(),
                                skin_ ? 0 : touch_.capacity().points));
  }
  if (!points.empty()) std::memcpy(points_.data(), points.data(), points.size_bytes());
  const auto count = static_cast<std::uint32_t>(points.size());
  total_.as<shader::ScanTotal>()[0] = {count, gpu::groups_for(count, 64), 1, 1};
}

HostStage::HostStage(const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
                     const Parameters& parameters)
    : cameras_(cameras.begin(), cameras.end()),
      tables_(sensing::make_rays(cameras)),
      bridge_cameras_(bridge_cameras(cameras, tables_)),
      table_(make_scene_table(solids, parameters)) {}

void HostStage::touch(std::span<const sensing::DepthFrame> images, const Parameters& parameters, Touch& out,
                      const Mark& mark, Tracks* tracks, double time_s) {
  const Box box = touchable_box(table_);
  sensing::plan_views(cameras_, tables_, box, views_);
  sensing::find_skin(tables_, images, box, views_, points_);
  if (mark) mark("skin");
  const Sight sight{bridge_cameras_, tables_, images};
  touch(points_, &sight, parameters, out, mark, tracks, time_s);
}

void HostStage::touch(std::span<const sensing::SkinPoint> points, const Parameters& parameters, Touch& out,
                      const Mark& mark, Tracks* tracks, double time_s) {
  touch(points, nullptr, parameters, out, mark, tracks, time_s);
}

void HostStage::touch(std::span<const sensing::SkinPoint> points, const Sight* sight, const Parameters& parameters,
                      Touch& out, const Mark& mark, Tracks* tracks, double time_s) const {
  check(parameters, table_);
  find_contacts(points, table_, parameters, out);
  if (mark) mark("contacts");
  find_fingers(parameters, table_, out);
  if (mark) mark("fingers");
  if (sight && parameters.finger_width_m > 0) {
    bridge_fingers(*sight, parameters, out);
    if (mark) mark("bridge");
  }
  find_frames(out);
  if (mark) mark("frames");
  if (tracks) {
    follow_fingers(*tracks, time_s, out);
    if (mark) mark("follow");
  }
  find_foci(parameters, table_.foci_of, out);
  if (mark) mark("foci");
}

}  // namespace palpa::touch
