// The values of a session; each is defined here once.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/focus_field.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "sensing/surroundings.hpp"
#include "session/links/safe_link.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/scheduler.hpp"
#include "session/predict/prediction.hpp"
#include "session/watch/events.hpp"
#include "touch/types.hpp"

namespace palpa::touch {
class KeptSolids;  // touch/contacts/prepared_solids.hpp
}  // namespace palpa::touch

namespace palpa::session {

/// The finger on which foci are computed (loop/live_fingers.hpp): tip at the origin, body along +y.
struct FollowedFinger {
  std::string name;     ///< its file, for messages
  geometry::Mesh body;  ///< as acoustics::body_mesh returns it
  acoustics::Air air;
};

struct SessionSetting {
  std::string scene = "scene";  ///< source of the solids, for messages
  std::vector<geometry::Solid> solids;
  /// Where the prepared solids are kept for other sessions with the same solids. Null: nowhere.
  std::shared_ptr<touch::KeptSolids> kept_solids{};
  std::vector<sensing::Camera> cameras;  ///< none: skin comes as points or from a tracker; otherwise as depth frames
  bool tracked = false;                  ///< without cameras: a tracker of hands gives capsules
  bool pushed = false;                   ///< without cameras: while it runs, another program pushes points
  array::Layout layout;                  ///< as posed in the world; without transducers, nothing is driven
  /// With cameras: skin on the layout's boards counts. Otherwise, points on the boards are no skin.
  bool keep_boards = false;
  /// With cameras: other things that are no skin. With cameras or a tracker: the room outside which nothing is.
  sensing::Surroundings surroundings{};
  touch::FingerOptions touch;
  ScheduleOptions schedule;
  array::DriveOptions drive;
  OwnSolver own_solver{};  ///< instead of the solver of `drive`; no finger may request a pressure
  /// The field of a focus for spectra and Tune::all, instead of the layout's field in free air. It must outlive the
  /// session.
  const acoustics::FocusField* field = nullptr;
  /// run() computes foci from the sound on the fingers that touch, each of which is assumed to be this one. Empty: from
  /// the free field.
  std::optional<FollowedFinger> finger;
  /// Empty: events are not requested. Fingers are then never deeper than delta, which saves looking at the deeper skin,
  /// unless a solid needs their depths (needs_depths), or may.
  std::optional<EventOptions> events = EventOptions{};
  bool feel_may_change = false;  ///< by Session::change_feel
  /// Fingers keep their ids from frame to frame, and also their axes and foci as the next two members say. False: each
  /// frame stands alone.
  bool follow = true;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
  /// With depth frames: a finger stays one until the evidence against it is strong. Needs `follow`.
  touch::Hysteresis hysteresis = touch::Hysteresis::on;
  /// Whether foci are moved to where their fingers will be when they sound. Without a fixed latency, only run()
  /// predicts, and only if frames do not wait.
  PredictOptions predict;
  /// How long a frame is valid after its capture if no other comes. Then comes silence, and fingers are released.
  double hold_s = 0.1;
  /// run() may lengthen the hold to longest_auto_hold_s if frames are late although work is shed
  /// (session/watch/effort.hpp).
  bool lengthens_hold = false;
  Safety safety;  ///< applied to every link
  /// The session never runs a loop. A frame may then have far more skin in the shell than a loop has room for.
  bool frame_by_frame = false;

  /// Whether it has everything that run() needs.
  bool live() const {
    return !frame_by_frame && (!cameras.empty() || tracked || pushed) && !layout.transducers.empty();
  }
};

/// The boards of a layout that is posed in the world.
std::vector<sensing::Slab> slabs_of(const array::Layout& layout);
/// Everything in the world that is no skin: the setting's surroundings and, unless it keeps them, its boards.
sensing::Surroundings surroundings_of(const SessionSetting& setting);
/// Whether a frame may have points that are no skin.
bool drops_points(const SessionSetting& setting);
/// Throws bad_usage if it tunes more than strides, which a loop cannot, or if events are asked for that it does not
/// have. `what` the session does, for the message: "runs".
void check_run(const SessionSetting& setting, bool asks_for_events, const char* what);

}  // namespace palpa::session
