// One live run from its options, as in `palpa run` and in the viewer. Everything that the options name is opened once,
// in an order in which an error leaves nothing behind.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/outputs.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/recording.hpp"
#include "session/control/osc.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "session/loop/run_observer.hpp"
#include "session/session.hpp"
#include "session/watch/event_sink.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/sessions/scene_reload.hpp"

namespace palpa::setup {

struct LiveOptions : FrameOptions {
  std::string link = "null";
  std::string board_files;
  Steps steps = Steps::on;
  bool steps_given = false;  ///< --steps is on the line
  bool every_frame = false;
  std::string record;
  bool overwrite = false;  ///< the folder of `record` may have a recording, which is replaced
  std::string osc;         ///< where messages come from (session::parse_osc_address); empty: from nowhere
  bool reload = false;     ///< the scene is read again when its file is saved
};
/// Throws bad_usage if options of the link or of the recording are unused; and as check() of the FrameOptions.
void check(const LiveOptions& options);

/// The report on stdout at the end of a run, beside --json.
enum class StatsFormat { none, json };

/// Adds the options for the link alone.
void add_link(const line::Group& group, LiveOptions& options);
/// Adds the same, and the options for other outputs of the frames, and for messages.
void add_link_options(const line::Group& group, LiveOptions& options);

/// The options of `palpa run`.
struct RunCommand : LiveOptions {
  StatsFormat stats = StatsFormat::none;
};
/// Adds them without the common ones. `frames`: the help text of --frames.
void add_run_options(CLI::App& app, RunCommand& options, const char* frames);

/// All files that such a run writes; `links` are all known links.
std::vector<Output> outputs_of(const LiveOptions& options, std::span<const session::LinkKind> links);

/// If neither --layout nor the rig names an array, sets the layout of the link's own boards, if it has any, and reports
/// it (log::info). Throws as sensing::load_rig and the link do.
void take_layout_of_link(RigOptions& rig, const std::string& link, std::span<const session::LinkKind> links);

/// take_method_of_boards() for a link that cannot follow foci that move fast.
void take_method_of_link(LiveOptions& options, std::span<const session::LinkKind> links);

/// take_dwell_of_boards() for a link whose boards take steps.
void take_dwell_of_link(LiveOptions& options, std::span<const session::LinkKind> links);

/// Whether a link gets drives slot by slot, and plays or keeps them: the modulation of foci that stand still is then
/// that of the slots. `links` are all known links.
bool plays_slot_by_slot(const std::string& link, std::span<const session::LinkKind> links);

class LiveRun final : session::RunChanges {
 public:
  /// Loads and opens all of it. `sources` and `links` are added to palpa's own; `stop` is the flag of the run. The
  /// calling thread, which must also call run(), has precedence from here on (threads.hpp), unless every frame is
  /// processed.
  LiveRun(const LiveOptions& options, std::span<const session::SourceKind> sources,
          std::span<const session::LinkKind> links, std::atomic<bool>& stop);

  session::Session& session() { return *prepared_.session; }
  sensing::DepthSource& source() { return *prepared_.source; }

  /// Calls Session::run; may be called only once. `observer` and `record` (see RunCommand) get events and frames after
  /// the outputs that the options name. `before_frame` is called as that of RunChanges, after OSC's. Warns of frames
  /// that were not recorded. Throws as Session::run, the sink and the recorder do.
  session::LoopStats run(session::RunObserver& observer = session::no_observer,
                         const std::function<void(const sensing::FrameSet&)>& record = {},
                         std::function<void(session::Session&)> before_frame = {});

 private:
  std::unique_ptr<session::Link> open_link(std::span<const session::LinkKind> links);
  void watch_scene();
  void before_frame(session::Session& session) override;
  bool has_scene() const override { return reload_ && reload_->ready(); }
  void take_scene(session::Session& session) override;

  LiveOptions options_;
  std::atomic<bool>* stop_;
  std::unique_ptr<session::Osc> osc_;
  std::function<void(session::Session&)> before_frame_;
  SceneState scene_state_;
  Prepared prepared_;
  std::optional<SceneReload> reload_;
  std::unique_ptr<session::EventSink> sink_;
  std::optional<sensing::RecordingWriter> recorder_;
  std::unique_ptr<session::Link> link_;
};

/// Fills in what computed a run, and why.
void tell_backend(const ComputeOptions& options, session::LoopStats& stats);

/// The measurements of a run as text, one per line, including every finger's pressure. If the run was recorded, the
/// first line says how many frames are in the `recording`, and how many are missing. A ceiling of 0 has a line of its
/// own, because it is a request for silence, of which nothing warns.
std::string summary(const session::LoopStats& stats, const std::string& recording = {}, double ceiling = 1);

/// palpa's own links and the given ones, which replace those of the same name.
std::vector<session::LinkKind> with_builtin(std::span<const session::LinkKind> links);

}  // namespace palpa::setup
