// What `palpa run`, `palpa export` and the viewer have in common: a scene, frames from a source, the session that looks
// at them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "session/links/sources.hpp"
#include "session/session.hpp"
#include "session/watch/event_sink.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"
#include "setup/values.hpp"

namespace palpa::setup {

struct FrameOptions {
  CommonOptions common;
  std::string scene;
  std::optional<std::uint32_t> gltf_scene;
  std::string source = "synthetic";
  RigOptions rig;
  SolidOptions solids;
  TouchOptions touch;
  DriveOptionsGroup drive;
  session::Safety safety;
  double hold_s = 0.1;
  bool hold_auto = false;  ///< it may be lengthened
  std::uint64_t frames = 0;
  bool noise_free = false;
  std::string events;
  bool watched = false;  ///< somebody looks at contacts and events, also where none are written
  session::EventOptions event;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
};

/// palpa's own sources and these, which take the place of those of the same name.
std::vector<session::SourceKind> with_builtin(std::span<const session::SourceKind> sources);

/// Scene, source and what comes of the frames; `until` explains --frames.
void add_frame_options(const Group& group, FrameOptions& options, const char* until);
/// Of these what comes of the frames.
void add_loop_options(const Group& group, FrameOptions& options);
/// How fingers are followed.
void add_following_options(CLI::App& app, FrameOptions& options);
/// All else that a session needs, in groups of their own; `foci`: what the number of foci is called.
void add_session_options(CLI::App& app, FrameOptions& options, const char* foci = "--foci");
/// Throws bad_usage where options are missing or go unused.
void check(const FrameOptions& options);

/// What the options make, members in the order in which they are needed: the session goes first.
struct Prepared {
  std::unique_ptr<sensing::DepthSource> source;
  std::unique_ptr<gpu::Device> device;  ///< none where the processor computes
  std::unique_ptr<session::Session> session;
};
/// Loads and opens all of it, showing what takes long, and warns of what is unusual. `sources` come beside palpa's own,
/// and take the place of those of the same name. `paced`: frames in real time.
Prepared prepare(const FrameOptions& options, std::span<const session::SourceKind> sources, bool paced);
/// Lines of what fingers that asked for a pressure had; nothing where none did.
std::string pressures_summary(std::span<const session::FingerPressure> fingers, std::span<const std::string> solids);
/// Hands over what waits. After an error that error is the one to report, not another of the sink's.
void finish(session::EventSink* sink, bool after_error);
/// Warns once that a frame had more fingers than are played.
void warn_of_left_out_fingers(const touch::Touch& touch, bool& warned);

}  // namespace palpa::setup
