// The computation of `palpa export --played`: the drives of foci that were played before, for example in a touch of a
// study, computed again on the host.
#pragma once

#include <atomic>

#include "session/replay.hpp"
#include "setup/tasks/export.hpp"

namespace palpa::setup {

/// Only `played`, `drives`, `rig`, `drive`, `hold_s` and `safety` of the task are used. Writes the drives. Throws as
/// load_played_foci, load_posed_rig and open_record_link do; bad_usage without `drives`.
ExportResult export_played(const ExportTask& task, std::atomic<bool>& stop);

}  // namespace palpa::setup
