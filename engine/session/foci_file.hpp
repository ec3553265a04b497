// The foci of a run as a file. `.json`: {"slot_s": 0.0015, "frames": [{"slot": 0, "time_s": ..., "fingers": [...]},
// ...]}, each of "frames" being a line of the stream of foci (session/foci_link.hpp) and the first slot that plays it.
// `.csv`: slot,time_s,finger,solid,focus,x,y,z,gain, a row per focus: its number in the finger's order of sectors and
// its place in the world, metres. A frame without fingers has no row.
#pragma once

#include <memory>
#include <string>

#include "session/link.hpp"

namespace palpa::session {

/// Whole or not there: finish() puts it into its place. "-" is JSON on stdout. Throws bad_usage for another ending,
/// failure() where the file cannot be written.
std::unique_ptr<Link> open_foci_file(const std::string& file, const LinkSetting& setting);

/// Throws bad_usage for another ending than these two.
void check_foci_file(const std::string& file);

}  // namespace palpa::session
