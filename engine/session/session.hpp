// A session: a scene's solids, the array, and the cameras or another source of skin, from touch to sound. It is the
// object on which palpa's own programs and yours are built, for a live loop or frame by frame.
//
//   session::Session session({.solids = solids, .cameras = source.cameras(), .layout = layout});
//   session.run(source, link, stop);      until the source ends or `stop` becomes true; ends with silence
//
//   session::Session session({.solids = solids});
//   session.touch(skin, time_s);          one frame on the calling thread: fingers, then events() and schedule()
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.hpp"
#include "sensing/depth_source.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/loop/run_options.hpp"
#include "session/plan/planner.hpp"
#include "session/plan/setting.hpp"
#include "session/watch/events.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

class Session {
 public:
  /// On the CPU. Throws bad_usage for invalid values, and bad_input naming a solid whose stride and foci share a
  /// divisor.
  explicit Session(SessionSetting setting);
  /// On `device`, which must outlive it. Finds the same fingers.
  Session(const gpu::Device& device, SessionSetting setting);
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  /// How its drives are computed.
  array::DrivenBy driven_by() const;
  const SessionSetting& setting() const;
  const std::vector<geometry::Solid>& solids() const { return setting().solids; }
  const std::vector<std::string>& solid_names() const;
  /// The name of the event's solid.
  const std::string& solid_name(const Event& event) const { return solid_names()[event.solid]; }
  /// The setting with which a link is opened.
  LinkSetting link_setting() const;

  // ---- live -------------------------------------------------------------------------------------------------------

  /// Capture, compute and output, each on its own thread: the newest frame wins, drives leave on time even when a frame
  /// is late, and the last drive that `link` gets is all-zero, whatever happens. Runs until the source ends,
  /// `options.frames` are done, `stop` becomes true or something fails. An Error of any thread is thrown here, after
  /// silence; `stop` is then also true. At the end, fingers that still touch are released. The setting must be live(),
  /// with the source's cameras. Frames in progress at the end are discarded. All times are those of `clock`.
  LoopStats run(sensing::DepthSource& source, Link& link, std::atomic<bool>& stop, const RunOptions& options = {},
                const Clock& clock = Clock());

  // ---- frame by frame ---------------------------------------------------------------------------------------------

  /// Processes the next frame: skin points in metres, world, and the time of their capture. Fingers keep their ids from
  /// frame to frame. If the first slot that plays the frame is known, gains change from slot to slot (plan/feel.hpp).
  /// The result, and everything below, is valid until the next call. Throws bad_usage for the wrong kind of skin.
  const touch::Touch& touch(std::span<const glm::vec3> skin, double time_s,
                            std::optional<std::uint64_t> first_slot = {});
  /// The same for points with ascending indices.
  const touch::Touch& touch(std::span<const sensing::SkinPoint> skin, double time_s,
                            std::optional<std::uint64_t> first_slot = {});
  /// The same for depth frames, one per camera, as DepthSource::next returns them. With the setting's latency, foci are
  /// predicted slot by slot from the first slot on, or without one, for the middle of their cycle.
  const touch::Touch& touch(std::span<const sensing::DepthFrame> images, double time_s,
                            std::optional<std::uint64_t> first_slot = {});
  /// The same for the hands of a tracker, as DepthSource::next returns them. `in_doubt`: others were left out.
  const touch::Touch& touch(std::span<const sensing::Capsule> hands, double time_s, std::uint64_t first_slot,
                            bool in_doubt = false);

  /// The events of the frame.
  std::span<const Event> events() const;
  /// The frame's foci. array::foci_of_slot gives those that sound in a slot; array::drive_for gives a layout's drive
  /// for them.
  const array::Schedule& schedule() const { return plan().schedule; }
  /// The schedule, and the drives of its slots if the setting has an array.
  const Plan& plan() const;
  /// How the frame's fingers got their voices.
  const Scheduler& scheduler() const;
  /// The array's field around a focus, for spectra; nullptr if there is no array or the setting has a spot.
  const acoustics::FocusField* field() const;
  /// The times of the frame's passes and other data about it.
  const FrameReport& report() const;

  /// Prepares the device, and reports it if it takes a while (base/activity.hpp): drivers compile kernels when they are
  /// first dispatched. run() does this itself. The first touch() does it without a report.
  void warm_up();

  /// Moves a solid for the frames that follow: T_world_rest takes it from its place in the scene to its current place.
  /// It must be a rigid transform; nothing is rebuilt. A solid that is moved by more than touch::out_of_reach_m is not
  /// touched, and costs nothing. During run(), call it only from RunObserver::planned and RunChanges::before_frame.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest);

  /// Changes how a solid feels for the frames that follow. During run(), call it only as set_pose(). Throws bad_usage
  /// for a setting without feel_may_change.
  void change_feel(std::uint32_t solid, const FeelChange& change);

  /// The foci of the frames that follow sound at this offset from where they are seen, metres in the world. During
  /// run(), call it only from RunObserver::planned and RunChanges::before_frame.
  void set_aim(const Vec3& offset);

  /// Exchanges the two sessions' scenes. Ids of fingers go on counting, and a finger that presses does not press again.
  /// During run(), call it only from
  /// RunChanges::take_scene, with a session that has the same setting except for the solids, the same slot, and no
  /// frame in progress. What was made with this session's values, such as its link, needs the first scene until its
  /// end.
  void exchange_scene(Session& other);

  /// To be called if no frame has come for the setting's hold: returns the releases of fingers that do not come back in
  /// time (EventTracker::expire).
  std::span<const Event> expire();
  /// Ends the stream of frames: returns the releases of fingers that still touch.
  std::span<const Event> end();

 private:
  struct State;
  class Observer;
  class ScenePlanner;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::session
