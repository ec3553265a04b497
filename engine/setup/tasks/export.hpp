// What `palpa export` computes: what a source of frames would sound like and report, on its own clock
// (session/replay.hpp), to files and to links of the caller. Metres in the world, seconds.
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
#include "setup/frames.hpp"

namespace palpa::setup {

struct ExportTask : FrameOptions {
  std::string foci;    ///< file, .csv or .json (session/links/foci_file.hpp); empty: none
  std::string drives;  ///< file as the link record:FILE writes it; empty: none
};
/// Throws bad_usage, which names the command's options, where they do not fit each other, where the source would never
/// end, and where nothing is to be written although no other link wants it: `own_links`.
void check(const ExportTask& task, std::span<const session::SourceKind> sources, bool own_links = false);

/// A focus of a frame, as a row of the foci's file has it.
struct FocusRow {
  std::uint64_t slot = 0;  ///< the first that plays the frame
  double time_s = 0;       ///< when the frame was captured
  std::uint32_t finger = 0, solid = 0;
  std::uint32_t focus = 0;  ///< its number in the finger's list of foci
  glm::vec3 position{0};
  double gain = 1;
};
/// A link that keeps the foci of all frames.
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
  bool stopped = false;  ///< before the end: the foci's file is not written
};
/// What `palpa export --json` writes (docs/files.md).
std::string to_json(const ExportResult& result);

class ExportRun {
 public:
  /// Loads and opens all that the task, which has passed check(), names, files to write too. `sources` come beside
  /// palpa's own; `links`, which outlive it, get all that the files get; `stop` ends the run. Throws as prepare and
  /// what opens the files do.
  ExportRun(const ExportTask& task, std::span<const session::SourceKind> sources, std::atomic<bool>& stop,
            std::span<session::Link* const> links = {});
  ~ExportRun();
  ExportRun(const ExportRun&) = delete;
  ExportRun& operator=(const ExportRun&) = delete;

  /// Once, until the source or the task's number of frames ends, or `stop` becomes true. `looking` is called beside
  /// what the task asks for, its `frames` do not count. Warns of fingers that are left out. The foci's file is put in
  /// its place at the end, if nothing failed and nobody stopped it. Throws as session::replay and the links do.
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
