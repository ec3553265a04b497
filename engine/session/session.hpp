// A session: a scene's solids, the array, and the cameras or whoever else sees the skin, from touch to sound. The one
// object that palpa's own programs and yours stand on, for a live loop or frame by frame.
//
//   session::Session session({.solids = solids, .cameras = source.cameras(), .layout = layout});
//   session.run(source, link, stop);      until the source ends or `stop` becomes true; silence is the last that sounds
//
//   session::Session session({.solids = solids});
//   session.touch(skin, time_s);          one frame on the calling thread: fingers, then events() and schedule()
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.hpp"
#include "sensing/depth_source.hpp"
#include "session/links/link.hpp"
#include "session/loop/run_options.hpp"
#include "session/plan/planner.hpp"
#include "session/plan/setting.hpp"
#include "session/watch/events.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

class Session {
 public:
  /// On the CPU. Throws bad_usage on unusable values, bad_input naming a solid whose stride and foci do not go
  /// together.
  explicit Session(SessionSetting setting);
  /// On `device`, which outlives it. The same fingers.
  Session(const gpu::Device& device, SessionSetting setting);
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  const SessionSetting& setting() const;
  const std::vector<geometry::Solid>& solids() const { return setting().solids; }
  const std::vector<std::string>& solid_names() const;
  /// Of the event's solid.
  const std::string& solid_name(const Event& event) const { return solid_names()[event.solid]; }
  /// What a link is told when it is opened.
  LinkSetting link_setting() const;

  // ---- live -------------------------------------------------------------------------------------------------------

  /// Capture, compute and output, each on its own thread: the newest frame wins, drives leave on time even when a frame
  /// is late, and an all-zero drive is the last that `link` gets, whatever happens. Until the source ends,
  /// `options.frames` are done, `stop` becomes true or something fails: an Error of any thread is thrown here, after
  /// silence; `stop` is true then, too. Who still touches then lets go. The setting must be
  /// live(), its cameras the source's. Frames under way at the end are not looked at.
  LoopStats run(sensing::DepthSource& source, Link& link, std::atomic<bool>& stop, const RunOptions& options = {});

  // ---- frame by frame ---------------------------------------------------------------------------------------------

  /// The next frame: skin points in metres, world, and when they were seen. Fingers keep their ids from frame to frame.
  /// The result is valid until the next call, as is all below. Throws bad_usage for the wrong kind of skin.
  const touch::Touch& touch(std::span<const glm::vec3> skin, double time_s);
  /// The same for points with indices, which ascend.
  const touch::Touch& touch(std::span<const sensing::SkinPoint> skin, double time_s);
  /// The same for depth frames, one of each camera: DepthSource::next gives them.
  const touch::Touch& touch(std::span<const sensing::DepthFrame> images, double time_s);

  /// Told by the frame.
  std::span<const Event> events() const;
  /// Its foci: array::foci_of_slot says which of them sound in a slot, array::drive_for what a layout does for them.
  const array::Schedule& schedule() const { return plan().schedule; }
  /// The schedule with the drives of its slots, where the setting has an array.
  const Plan& plan() const;
  /// How its fingers came to their voices.
  const Scheduler& scheduler() const;
  /// What its array gives around a focus, for spectra; nullptr where it has none or the setting has a spot.
  const acoustics::FocusField* field() const;
  /// What each of its passes took, and whatever else is known of it.
  const FrameReport& report() const;

  /// Lets the device get ready, and says so where it takes a while (base/activity.hpp): drivers compile kernels when
  /// they are first dispatched. run() does it by itself; the first frame that is touched does it without a word.
  void warm_up();

  /// Moves a solid for the frames that follow: T_world_rest takes its place in the scene to where it is now. A rigid
  /// transform; nothing is rebuilt. While it runs: from whoever looks on at what is `planned`.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest);

  /// The foci of the frames that follow sound so far from where they are seen, metres in the world. While it runs: from
  /// what looks on at planned frames.
  void set_aim(const Vec3& offset);

  /// No more frames will come: the releases of whoever still touches.
  std::span<const Event> end();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::session
