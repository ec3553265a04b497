#include "setup/sessions/touch_run.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "shaders/touch/contacts/contacts.h"

namespace palpa::setup {
namespace {

void check_points(const TouchInput& input) {
  constexpr std::uint32_t most = shader::contacts_most_points;
  if (input.points.size() <= most) return;
  throw bad_usage(
      fmt::format("--points: {} points are more than the {} of one frame on the GPU; --backend cpu takes them",
                  input.points.size(), most));
}

}  // namespace

OneTouch touch_once(const ComputeOptions& compute, const TouchOptions& touch, const FeltOptions& felt,
                    const std::string& scene, std::vector<geometry::Solid> solids, const TouchInput& input,
                    TouchArray array, StepTimes& times, session::OwnMethod own_method,
                    std::shared_ptr<touch::KeptSolids> kept_solids) {
  Stopwatch watch;
  session::SessionSetting setting{.scene = scene,
                                  .solids = std::move(solids),
                                  .kept_solids = std::move(kept_solids),
                                  .cameras = input.cameras,
                                  .layout = std::move(array.layout),
                                  .keep_boards = true,  // the array of a single touch need not stand in the images
                                  .touch = touch.parameters,
                                  .schedule = schedule_options(touch, felt),
                                  .drive = array.drive,
                                  .field = array.field,
                                  .events = std::nullopt,
                                  .follow = false,
                                  .frame_by_frame = true};
  setting.schedule.voice.pressure_pa = array.pressure_pa;
  setting.schedule.own_method = std::move(own_method);
  if (on_gpu(compute)) check_points(input);
  UsedDevice device(compute);
  session::Session session =
      device.get() ? session::Session(*device.get(), std::move(setting)) : session::Session(std::move(setting));
  times.emplace_back("setup", watch.lap_ms());
  const touch::Touch& found = input.cameras.empty() ? session.touch(input.points, 0) : session.touch(input.frames, 0);
  if (device.get()) times.emplace_back("submit to result", watch.lap_ms());
  for (const gpu::PassTime& pass : session.report().passes)
    times.emplace_back(pass.name, pass.ms);
  return {std::move(device), std::move(session), found};
}

}  // namespace palpa::setup
