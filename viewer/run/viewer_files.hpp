// All files that the viewer's command line names, known before anything is opened.
#pragma once

#include <vector>

#include "base/outputs.hpp"
#include "viewer/app/viewer_options.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/run/script.hpp"

namespace palpa::viewer {

/// What it writes: its own pictures and results, a script's shots, and what a live run writes.
std::vector<Output> outputs_of(const ViewerOptions& options, const Script& script, const LiveSession::Kinds& kinds);

/// What it reads, some of it late or on other threads: throws bad_usage where an output has one of these names.
void refuse_outputs_as_inputs(const ViewerOptions& options);

}  // namespace palpa::viewer
