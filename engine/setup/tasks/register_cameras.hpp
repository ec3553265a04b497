// The poses of cameras from touches, in `palpa calibrate --by-touch`: foci sound one after the other, and a person
// touches each with a fingertip that points to the array. Where a camera saw the fingertip gives its pose. Metres.
//
// 1. The first frames show no hand: they are the background. Whatever is nearer later is the hand.
// 2. The end of the hand that is nearest to the array, or lowest in an array that is all around, is a ball
//    (sensing/find_fingertip.hpp). The focus is at this end: the ball's centre is a radius farther away from the array,
//    or higher. Where the array is, is known from the pose: the first time the rig's, then the one that was found,
//    until it no longer changes.
// 3. The pose is the rigid transform of the centres to these places (rigid_fit.hpp), with less weight for touches
//    that fit badly, and without one that stands out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "sensing/background.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "session/links/sources.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/tasks/touch_steps.hpp"

namespace palpa::setup {

/// Where the foci sound before they are nudged, in the world: wide apart, because the directions of poses follow from
/// their distances, and around the place of objects.
inline constexpr std::array<Vec3, 8> camera_foci{{{-0.06, -0.07, -0.06},
                                                  {0.06, 0.02, -0.06},
                                                  {0.06, -0.07, 0.06},
                                                  {-0.06, 0.02, 0.06},
                                                  {0.06, -0.07, -0.06},
                                                  {-0.06, 0.02, -0.06},
                                                  {-0.06, -0.07, 0.06},
                                                  {0.06, 0.02, 0.06}}};

/// The hand that touches a focus, as a camera saw it in a few frames, in the camera's frame. Empty frames: not seen.
struct SeenTouch {
  Vec3 focus_m{};  ///< world
  std::vector<std::vector<Vec3>> frames;
};

/// A touch that was left out, because it does not fit the others.
struct WrongTouch {
  std::size_t focus = 0;  ///< its number, from 0
  double off_m = 0;       ///< from where the others say that the focus was
};

struct TouchedCamera {
  std::string name;
  Transform T_world_camera{1.0};
  double residual_m = 0;               ///< rms distance of the fingertips from where the foci say they were
  double moved_m = 0, turned_rad = 0;  ///< relative to the guess
  std::size_t seen = 0;                ///< how many of the touches that it saw count
  std::optional<WrongTouch> wrong{};
};

/// At least so many touches give a pose.
inline constexpr std::size_t least_touches = 5;

/// `guess`: the pose so far; only the direction of the array counts. Throws failure naming the camera if it saw fewer
/// than least_touches fingertips, if they lie nearly on a line, or if they remain more than 12 mm off (rms).
TouchedCamera register_camera(const sensing::Camera& guess, std::span<const SeenTouch> touches,
                              const array::Layout& layout);

/// The touches of a run. Its source, its method and its keys use it on three threads.
class CameraTouches final : public TouchSteps {
 public:
  /// `layout`: as posed in the world.
  explicit CameraTouches(const array::Layout& layout) : layout_(&layout) {}

  /// The source `joints` of a session, which takes the cameras of its argument, one of `kinds`: a fingertip in the top
  /// of assets/cube.glb as soon as the background is known, so that the focus sounds.
  session::SourceKind source(std::vector<session::SourceKind> kinds);
  /// Places the current focus.
  session::OwnMethod method();
  /// The source "synthetic" of a rehearsal: the rig's cameras see the boards and assets/finger.ply, whose tip is
  /// `off_m` (rms) away from each focus. `noise`: that of a D415.
  session::SourceKind rehearsal(double off_m, bool noise);

  void nudge(const Vec3& offset) override;
  std::string take(double time_s) override;
  std::string line() const override;
  bool complete() const override;
  /// The current focus; nullopt while the background is learned.
  std::optional<Vec3> focus() const;
  /// How many foci were touched.
  std::size_t touched() const;

  /// The cameras' frames. Another run of the same touches looks at the empty place again.
  void begin(std::vector<sensing::Camera> cameras);
  void see(const sensing::FrameSet& set);

  /// Throws as register_camera(). `rig`: the cameras with their poses so far.
  std::vector<TouchedCamera> result(std::span<const sensing::Camera> rig) const;

 private:
  struct Hands {
    double time_s = 0;
    std::vector<std::vector<Vec3>> by_camera;
  };
  Vec3 place() const;
  void learn(const sensing::FrameSet& set);

  const array::Layout* layout_;
  mutable std::mutex mutex_;
  std::vector<sensing::Camera> cameras_;  ///< with their background, once it is learned
  std::vector<sensing::RayTables> rays_;
  std::vector<sensing::BackgroundFrames> learning_;
  std::uint64_t learned_frames_ = 0;
  bool learned_ = false;
  std::deque<Hands> recent_;
  bool on_its_way_ = false;  ///< the next frame may have been taken before the last touch was
  Vec3 offset_{0};
  std::vector<std::vector<SeenTouch>> touches_;  ///< by focus, then by camera
};

}  // namespace palpa::setup
