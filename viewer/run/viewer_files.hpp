// All files that the viewer's command line names, known before anything is opened.
#pragma once

#include <vector>

#include "base/files/outputs.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"
#include "viewer/run/script.hpp"

namespace palpa::viewer {

/// What the viewer writes: its own pictures and results, a script's shots, and what a live run writes.
std::vector<Output> outputs_of(const ViewerOptions& options, const Script& script, const LiveSession::Kinds& kinds);

/// Throws bad_usage if an output has the name of an input. Some inputs are read late or on other threads.
void refuse_outputs_as_inputs(const ViewerOptions& options);

}  // namespace palpa::viewer
