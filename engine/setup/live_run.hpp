// One live run from its options: what `palpa run` is, and what the viewer looks on at. Everything that the options name
// is opened once, in the order in which a fault leaves nothing behind.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/outputs.hpp"
#include "sensing/recording.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "session/session.hpp"
#include "session/watch/event_sink.hpp"
#include "setup/frames.hpp"

namespace palpa::setup {

struct LiveOptions : FrameOptions {
  std::string link = "null";
  std::string board_files;
  bool every_frame = false;
  std::string record;
};
/// What stdout is told of a run when it ends, beside --json.
enum class StatsFormat { none, json };
void add_stats_option(const Group& group, StatsFormat& stats);

/// Where drives go, and what else becomes of the frames.
void add_link_options(const Group& group, LiveOptions& options);

/// All that such a run writes; `links` are all there are.
std::vector<Output> outputs_of(const LiveOptions& options, std::span<const session::LinkKind> links);

/// Where neither --layout nor the rig says which array it is, that of the link's own boards, if it has any. Says so
/// (log::info). Throws as sensing::load_rig and the link do.
void take_layout_of_link(RigOptions& rig, const std::string& link, std::span<const session::LinkKind> links);

/// Where the line names no method and the link cannot follow foci that move so fast, single-focus. Warns.
void take_method_of_link(LiveOptions& options, std::span<const session::LinkKind> links);

class LiveRun {
 public:
  /// Loads and opens all of it. `sources` and `links` come beside palpa's own; `stop` is the run's. The calling thread,
  /// which is to run it, goes first from here on (threads.hpp), unless every frame is looked at.
  LiveRun(const LiveOptions& options, std::span<const session::SourceKind> sources,
          std::span<const session::LinkKind> links, std::atomic<bool>& stop);

  session::Session& session() { return *prepared_.session; }
  sensing::DepthSource& source() { return *prepared_.source; }

  /// Session::run, once. `looking` is called beside what the options ask for, after it. Warns of frames that were not
  /// written down. Throws as Session::run does, and what a sink or a recorder throws.
  session::LoopStats run(const session::RunOptions& looking = {});

 private:
  std::unique_ptr<session::Link> open_link(std::span<const session::LinkKind> links);

  LiveOptions options_;
  std::atomic<bool>* stop_;
  Prepared prepared_;
  std::unique_ptr<session::EventSink> sink_;
  std::optional<sensing::RecordingWriter> recorder_;
  std::unique_ptr<session::Link> link_;
};

/// What a run has measured, for people: a line each, with that of every finger's pressure.
std::string summary(const session::LoopStats& stats);

/// palpa's own links and these, which take the place of those of the same name.
std::vector<session::LinkKind> with_builtin(std::span<const session::LinkKind> links);

}  // namespace palpa::setup
