#include "viewer/app/shown_sensation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "array/plausible.hpp"
#include "setup/sessions/play.hpp"

namespace palpa::viewer {
namespace {

/// The focus leaves a trail as long as one turn of the fastest brush, at most.
constexpr std::uint64_t trail = 16;

sensation::PatternSensation loaded(const std::string& name, std::span<const std::string> parameters) {
  sensation::Pattern pattern = setup::load_sensation(name);
  const auto given = setup::parameters_of(parameters, pattern);
  return sensation::PatternSensation(std::move(pattern), given);
}

}  // namespace

ShownSensation::ShownSensation(const std::string& name, std::span<const std::string> parameters, double period_s,
                               const Transform& T_world_array)
    : name_(std::filesystem::path(name).stem().string()),
      sensation_(loaded(name, parameters)),
      slot_s_(setup::usual_slot(setup::playable(sensation_.fastest_hz(), name), period_s)),
      T_world_array_(T_world_array) {}

void ShownSensation::evaluate(std::uint64_t slot) {
  std::vector<double> times;
  for (std::uint64_t s = points_.size(); s <= slot && s < setup::most_offline_slots && !whole_; ++s)
    times.push_back(static_cast<double>(s) * slot_s_);
  const auto known = static_cast<std::ptrdiff_t>(points_.size());
  sensation_.points(times, state_, points_);
  const auto stop = std::ranges::find(points_.begin() + known, points_.end(), true, &sensation::Point::stop);
  whole_ = whole_ || stop != points_.end() || points_.size() >= setup::most_offline_slots;
  points_.erase(stop, points_.end());
  if (points_.empty()) points_.emplace_back();
}

array::SlotFocus ShownSensation::show(Picture& picture, std::uint64_t slot) {
  evaluate(slot);
  const std::uint64_t now = slot % points_.size();
  FingerMarks marks;
  for (std::uint64_t s = now - std::min(now, trail - 1); s <= now; ++s) {
    if (points_[s].gain == 0 && s != now) continue;
    const auto place = glm::vec3(transform_point(T_world_array_, points_[s].place_m));
    marks.foci.push_back({place, static_cast<std::uint32_t>(s), points_[s].gain > 0});
  }
  const sensation::Point& point = points_[now];
  if (point.gain > 0) marks.running = static_cast<std::uint32_t>(marks.foci.size() - 1);
  marks.sensation =
      fmt::format("{}: {:.4f} s, intensity {:.2f}", name_, static_cast<double>(now) * slot_s_, point.gain);
  picture.fingers = {std::move(marks)};
  const Vec3 place = transform_point(T_world_array_, point.place_m);
  const bool sounds = array::drivable({.position = place});
  return {.position = sounds ? place : Vec3(0), .gain = sounds ? static_cast<float>(point.gain) : 0};
}

}  // namespace palpa::viewer
