// Shared by `palpa run`, `palpa export` and the viewer: a scene, frames from a source, and the session that processes
// them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "line/values.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "session/pushed_points.hpp"
#include "session/session.hpp"
#include "session/watch/event_sink.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::setup {

struct FrameOptions {
  CommonOptions common;
  std::string scene;
  /// The scene's solids, if they come from no file; `scene` is then only their name in messages.
  std::shared_ptr<const std::vector<geometry::Solid>> made_solids{};
  std::optional<std::uint32_t> gltf_scene;
  std::string source = "synthetic";
  /// Frames that the caller pushes; `source` is then only their name in messages.
  std::optional<session::PushedPoints> points{};
  RigOptions rig;
  SolidOptions solids;
  TouchOptions touch;
  FocusingOptions drive;
  std::string finger;  ///< mesh for --transfer finger; empty: the asset
  session::Safety safety;
  bool ceiling_known = false;  ///< --ceiling is on the line, or its user knows of the default
  double hold_s = 0.1;
  bool hold_auto = false;  ///< the hold may be lengthened
  std::uint64_t frames = 0;
  bool noise_free = false;
  bool keep_boards = false;  ///< points on the array's boards count as skin
  std::string events;
  bool watched = false;          ///< contacts and events are used, even if no events are written
  bool feel_may_change = false;  ///< messages may change how solids feel
  session::EventOptions event;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
  std::optional<touch::Hysteresis> hysteresis;

  /// Unless it is given, it is off for frames that stand alone as in the paper.
  touch::Hysteresis chosen_hysteresis() const {
    const bool alone = axes == touch::Axes::covariance && smoothing == touch::Smoothing::none;
    return hysteresis.value_or(alone ? touch::Hysteresis::off : touch::Hysteresis::on);
  }
  std::optional<session::Predict> predict;  ///< default: automatic
  std::optional<double> predict_latency_s;

  /// For frames without a latency that could be measured. The first throws bad_usage if a prediction without a latency
  /// is requested; `who` names the frames. The second turns such a prediction off, which is the default.
  void refuse_unmeasured_prediction(const char* who) const;
  void leave_out_unmeasured_prediction();
  session::OwnMethod own_method{};  ///< instead of --method
  session::OwnSolver own_solver{};  ///< instead of --solver
};

/// The kinds, and of palpa's `own` those with other names.
template <typename Kind>
std::vector<Kind> added_to(std::vector<Kind> own, std::span<const Kind> kinds) {
  std::erase_if(own, [&](const Kind& one) { return std::ranges::find(kinds, one.name, &Kind::name) != kinds.end(); });
  own.insert(own.end(), kinds.begin(), kinds.end());
  return own;
}
/// palpa's own sources and the given ones, which replace those of the same name.
std::vector<session::SourceKind> with_builtin(std::span<const session::SourceKind> sources);

/// Adds the options of scene, source and the loop; `until` explains --frames.
void add_frame_options(const line::Group& group, FrameOptions& options, const char* until);
/// Adds only the options of the loop.
void add_loop_options(const line::Group& group, FrameOptions& options);
/// Adds --ceiling and --ramp. `ceiling_given`: set to true if --ceiling is on the line.
void add_safety(const line::Group& group, session::Safety& safety, bool* ceiling_given = nullptr);
/// Whether these options play at full amplitude, without their user having asked for that: there is neither a ceiling
/// nor a pressure.
bool is_loud_by_default(const FrameOptions& options);
/// Warns of that if the link is a board; `name` is that of the line.
void warn_of_full_amplitude(const FrameOptions& options, const std::string& name, const session::Link& link);
/// Adds the options for following fingers.
void add_following_options(CLI::App& app, FrameOptions& options);
/// Adds all other options of a session, in their own groups. `foci`: name of the option for the number of foci. `mesh`:
/// `known` for a session that runs live, which can compute foci on the fingers that touch.
void add_session_options(CLI::App& app, FrameOptions& options, FingerMesh mesh, const char* foci = "--foci");
/// Throws bad_usage if options are missing or unused.
void check(const FrameOptions& options);

/// The objects made from the options. The order of the members matters: the session is destroyed first.
struct Prepared {
  std::unique_ptr<sensing::DepthSource> source;
  UsedDevice device;  ///< none if the processor computes
  std::unique_ptr<session::Session> session;
};
/// Loads and opens all of it, shows the progress of long steps, and warns of unusual values. `sources` are added to
/// palpa's own and replace those of the same name. `paced`: frames in real time.
/// `mesh` as in add_session_options.
Prepared prepare(const FrameOptions& options, std::span<const session::SourceKind> sources, bool paced,
                 FingerMesh mesh = FingerMesh::unknown);
/// The scene of the options, read again, as a session with otherwise the same `setting`. Throws and warns as prepare().
std::unique_ptr<session::Session> prepare_again(const FrameOptions& options, const gpu::Device* device,
                                                session::SessionSetting setting);
/// Opens the source as prepare() does, and closes it again. Throws as the source does.
void try_source(const FrameOptions& options, std::span<const session::SourceKind> sources);
/// Lines about the pressures of fingers that requested one; empty if none did.
std::string pressures_summary(std::span<const session::FingerPressure> fingers, std::span<const std::string> solids);
/// Flushes the sink. After an error, that error is reported and not another one of the sink.
void finish(session::EventSink* sink, bool after_error);
/// Warns once if a frame has more fingers than are played.
void warn_of_left_out_fingers(const touch::Touch& touch, bool& warned);

}  // namespace palpa::setup
