// The computation of `palpa export --played`: the drives of foci that were played before, for example in a touch of a
// study, computed again on the host.
#pragma once

#include <atomic>

#include "line/values.hpp"
#include "session/replay.hpp"
#include "setup/tasks/export.hpp"

namespace palpa::setup {

/// Adds --played. The line is refused, with bad_usage, if it also has an option without an effect on such foci.
void add_played(CLI::App& app, const line::Group& group, ExportTask& task);

/// Only `played`, `drives`, `rig`, `drive`, `hold_s` and `safety` of the task are used. Writes the drives. Throws as
/// load_played_foci, load_posed_rig and open_record_link do; bad_usage without `drives`.
ExportResult export_played(const ExportTask& task, std::atomic<bool>& stop);

}  // namespace palpa::setup
