#include "setup/tasks/export_played.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <span>

#include "base/error.hpp"
#include "session/links/record_link.hpp"
#include "setup/files/played_foci.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::setup {

ExportResult export_played(const ExportTask& task, std::atomic<bool>& stop) {
  if (task.drives.empty()) throw bad_usage("--played goes with --drives, the file for the drives of these foci");
  if (task.hold_auto) throw bad_usage("--hold auto goes with palpa run: what was played is never late");
  const session::PlayedFoci played = load_played_foci(task.played);
  // As of the method that places such foci, so that they get its usual solver.
  const bool together = std::ranges::any_of(played.frames, [](const session::PlayedFoci::Frame& frame) {
    return std::ranges::any_of(std::span(frame.schedule.voices).first(frame.schedule.voice_count),
                               [](const array::Voice& voice) { return voice.foci_per_slot > 1; });
  });
  const touch::Method method = together ? touch::Method::multi_focus : touch::Method::cross_section;
  const PosedRig rig = load_posed_rig(task.rig);
  const session::OutputSetting setting{.layout = rig.layout,
                                       .drive = drive_options(task.drive, rig.layout, solving_of(method)),
                                       .slot_s = played.slot_s,
                                       .hold_s = task.hold_s,
                                       .safety = task.safety};
  check_frequency(rig.layout, setting.drive.medium);
  const std::unique_ptr<session::Link> drives = session::open_record_link(
      task.drives, {.layout = rig.layout, .solid_names = played.solids, .slot_s = played.slot_s}, &stop);
  ExportResult result{.stats = session::replay(played, setting, *drives, stop)};
  result.stopped = stop;
  return result;
}

}  // namespace palpa::setup
