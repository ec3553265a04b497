// The computation of `palpa export`: replays a source of frames on its own clock (session/replay.hpp) and sends its
// sound and events to files and to the caller's links. Metres in the world, seconds.
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "session/links/foci_file.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "session/replay.hpp"
#include "session/watch/event_sink.hpp"
#include "setup/sessions/frames.hpp"

namespace palpa::setup {

struct ExportTask : FrameOptions {
  std::string foci;    ///< file, .csv or .json (session/links/foci_file.hpp); empty: none
  std::string drives;  ///< file in the format of the link record:FILE; empty: none
  /// A file of foci to play again instead of the frames of a source; see export_played.hpp.
  std::string played;
};
/// Throws bad_usage, naming the command's options, if they do not fit together, if the source would never end, or if
/// there is no output. `own_links`: the caller has its own links, so no output file is needed.
void check(const ExportTask& task, std::span<const session::SourceKind> sources, bool own_links = false);

/// A focus of a frame, as in a row of the foci's file.
struct FocusRow {
  std::uint64_t slot = 0;  ///< the first slot that plays the frame
  double time_s = 0;       ///< when the frame was captured
  std::uint32_t finger = 0, solid = 0;
  std::uint32_t focus = 0;  ///< its number in the finger's list of foci
  glm::vec3 position{0};
  double gain = 1;
};
/// A link that collects the foci of all frames.
class FocusRows final : public session::Link {
 public:
  void plan(const session::PlayedPlan& plan) override;
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}

  const std::vector<FocusRow>& rows() const { return rows_; }

 private:
  std::vector<FocusRow> rows_;
};

struct ExportResult {
  session::ReplayStats stats;
  bool stopped = false;  ///< stopped before the end; the foci's file is not written
};
/// The output of `palpa export --json` (docs/run.md).
std::string to_json(const ExportResult& result);

class ExportRun {
 public:
  /// Loads and opens everything that the task names, including output files. The task must have passed check().
  /// `sources` are added to palpa's own. `links` must outlive this object and get the same data as the files. `stop`
  /// ends the run. Throws bad_usage if an option is given that none of the output files depends on, unless there are
  /// `links`; otherwise as prepare and the functions that open the files do.
  ExportRun(const ExportTask& task, std::span<const session::SourceKind> sources, std::atomic<bool>& stop,
            std::span<session::Link* const> links = {});
  ~ExportRun();
  ExportRun(const ExportRun&) = delete;
  ExportRun& operator=(const ExportRun&) = delete;

  /// Runs once, until the source or the task's number of frames ends, or `stop` becomes true. The functions in
  /// `looking` are called in addition to those of the task; its `frames` is ignored, and its `events` needs a task that
  /// is `watched` or writes events. Warns of fingers that are left
  /// out. The foci's file is moved into its place at the end, if nothing failed and nobody stopped the run. Throws as
  /// session::replay and the links do.
  ExportResult run(const session::ReplayOptions& looking = {});

 private:
  class Links;

  std::uint64_t frames_;
  std::atomic<bool>* stop_;
  Prepared prepared_;
  std::unique_ptr<session::EventSink> sink_;
  std::unique_ptr<session::FociFile> foci_;
  std::unique_ptr<session::Link> drives_;
  std::unique_ptr<Links> links_;
};

}  // namespace palpa::setup
