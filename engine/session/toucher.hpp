// Touching in one call, for programs that have skin points of their own: points in, fingers, events and a schedule out.
// One frame after the other on the calling thread; for cameras, threads and drives in time see run_loop.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "geometry/solid.hpp"
#include "gpu/device.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "session/events.hpp"
#include "touch/method.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// What the command line says for all solids; the extras of a solid's node take its place.
struct ToucherOptions {
  touch::Parameters touch;
  array::VoiceOptions voice;
  touch::MethodOptions method;
  bool tune = false;  ///< each finger's stride follows its perimeter
  EventOptions events;
  /// None: skin comes as points. Otherwise it comes as these cameras' depth frames.
  std::vector<sensing::Camera> cameras;
};

class Toucher {
 public:
  /// On the CPU. Throws bad_input naming a solid whose stride and foci do not go together, bad_usage on unusable
  /// options.
  explicit Toucher(std::vector<geometry::Solid> solids, const ToucherOptions& options = {});
  /// On `device`, which outlives it. The same fingers.
  Toucher(const gpu::Device& device, std::vector<geometry::Solid> solids, const ToucherOptions& options = {});
  ~Toucher();
  Toucher(Toucher&&) noexcept;
  Toucher& operator=(Toucher&&) noexcept;

  /// The next frame: skin points in metres, world, and when they were seen. Fingers keep their ids from frame to frame.
  /// The result is valid until the next call, as are events and schedule. Throws bad_usage for the wrong kind of skin.
  const touch::Touch& touch(std::span<const glm::vec3> skin, double time_s);
  /// The same for points with indices, which ascend.
  const touch::Touch& touch(std::span<const sensing::SkinPoint> skin, double time_s);
  /// The same for depth frames, one of each camera: DepthSource::next gives them.
  const touch::Touch& touch(std::span<const sensing::DepthFrame> images, double time_s);

  /// Told by the frame.
  std::span<const Event> events() const;
  /// Its foci: array::foci_of_slot says which of them sound in a slot, array::drive_for what a layout does for them.
  const array::Schedule& schedule() const;

  /// Moves a solid for the frames that follow: T_world_rest takes its place in the scene to where it is now. A rigid
  /// transform; nothing is rebuilt.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest);

  /// No more frames will come: the releases of whoever still touches.
  std::span<const Event> end();

  const std::vector<geometry::Solid>& solids() const;
  /// The name of the event's solid.
  const std::string& solid_name(const Event& event) const { return solids()[event.solid].name; }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::session
