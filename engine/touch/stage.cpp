#include "touch/stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "touch/check_parameters.hpp"
#include "touch/contacts/pixel_stride.hpp"
#include "touch/points/device_points.hpp"
#include "touch/points/host_points.hpp"
#include "touch/points/passes.hpp"

namespace palpa::touch {
namespace {

constexpr std::size_t most_times = 32;

PreparedSolids prepared(const std::vector<geometry::Solid>& solids, const StageSetting& setting) {
  PreparedSolids made = setting.kept_solids ? setting.kept_solids->prepare(solids, setting.parameters)
                                            : prepare_solids(solids, setting.parameters);
  check_parameters(setting.parameters, made);
  return made;
}

std::unique_ptr<Points> make_points(Passes* passes, const sensing::RayTables& tables, const PreparedSolids& solids,
                                    const StageSetting& setting) {
  if (passes) return std::make_unique<DevicePoints>(*passes, tables, solids, setting);
  return std::make_unique<HostPoints>(tables, solids, setting);
}

}  // namespace

Stage::Stage(Passes* passes, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
             const StageSetting& setting)
    : setting_(setting),
      cameras_(cameras.begin(), cameras.end()),
      tables_(sensing::make_rays(cameras)),
      solids_(prepared(solids, setting)),
      points_(make_points(passes, tables_, solids_, setting)),
      fingers_(setting, cameras, tables_, solids_) {
  crops_.reserve(cameras.size());
  volumes_.reserve(sensing::most_drops(setting.surroundings));
  times_.reserve(most_times);
}

std::uint32_t Stage::most_pixel_stride() const {
  if (cameras_.empty()) return 1;
  return touch::most_pixel_stride(cameras_, tables_, touchable_box(solids_), setting_.parameters);
}

void Stage::start(std::span<const sensing::DepthFrame> images, double time_s) {
  if (cameras_.empty()) throw bad_usage("a stage without cameras takes skin points, not depth frames");
  sensing::check_frames(tables_, images);
  const Box box = setting_.watched(touchable_box(solids_), true);
  sensing::plan_crops(cameras_, tables_, box, crops_);
  set_stride(crops_, stride_);
  sensing::plan_drops(setting_.surroundings, box, volumes_);
  start(Skin{.images = images, .box = box, .crops = crops_, .volumes = volumes_}, time_s);
}

void Stage::start(std::span<const sensing::SkinPoint> points, double time_s) {
  if (!cameras_.empty()) throw bad_usage("a stage with cameras takes depth frames, not skin points");
  start(Skin{.points = points}, time_s);
}

void Stage::start(std::span<const sensing::Capsule> hands, double time_s) {
  if (!cameras_.empty()) throw bad_usage("a stage with cameras takes depth frames, not hands");
  Box box = touchable_box(solids_);
  if (const std::optional<Box>& room = setting_.surroundings.room) {
    box.low = glm::max(box.low, room->low);
    box.high = glm::min(box.high, room->high);
  }
  too_large_ = !sensing::sample_skin(hands, box, hand_skin_);
  start(Skin{.points = hand_skin_}, time_s);
}

void Stage::start(Skin skin, double time_s) {
  times_.clear();
  images_ = skin.images;
  parameters_ = at_stride(setting_.parameters, stride_);
  skin.parameters = parameters_;
  skin.clustering = setting_.searched(parameters_, !cameras_.empty());
  skin.reach = fingers_.next(time_s);
  points_->start(skin);
}

void Stage::finish(Touch& out) {
  try {
    points_->finish(out, times_);
    if (std::exchange(too_large_, false))
      throw TooMuchSkin(fmt::format("the hands have more than {} skin points", sensing::most_hand_points));
  } catch (...) {
    forget();
    throw;
  }
  fingers_.find(images_, parameters_, out, times_);
}

}  // namespace palpa::touch
