// The two ways to look at what the options show: pictures without a window, and a window.
#pragma once

#include "setup/options/study_options.hpp"
#include "viewer/app/touch_guide.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// Draws --frames pictures, one slot each. Writes all of them or the last, and compares the last. Throws failure() if
/// it differs from the reference by more than the threshold.
void run_headless(const ViewerOptions& options);

/// Without a window, but with interaction: does what --interact says, or draws --frames pictures of a live run, at most
/// one for each of its frames. Then writes the last picture and compares it as run_headless does. `guide`: null, or
/// what guides a person through the run.
void run_scripted(const ViewerOptions& options, const LiveSession::Kinds& kinds, TouchGuide* guide);

/// Opens a window, and draws until it is closed or --frames have been drawn. The running focus moves on in slow motion,
/// one slot every quarter of a second. With --frames, it moves on with every frame.
void run_window(const ViewerOptions& options, const LiveSession::Kinds& kinds, TouchGuide* guide);

/// A participant's sitting in two windows. After a signal, the program ends within this function, as after a failure;
/// the same command continues.
void run_study(const setup::StudyRunOptions& options, const LiveSession::Kinds& kinds);

}  // namespace palpa::viewer
