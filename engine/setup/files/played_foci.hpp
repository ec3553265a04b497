// Reads a file of foci back, so that it can be played again: what `palpa export --foci FILE.json` or a touch of a study
// wrote. The format is in docs/run.md.
#pragma once

#include <filesystem>

#include "session/replay.hpp"

namespace palpa::setup {

/// A voice that has a "pressure_pa" asks for it, at a gain of 1, because the pressure already includes the gain. Throws
/// bad_input if the file is not one of foci, for a frame whose slot is before that of the frame before, for an invalid
/// finger, and for more fingers than a frame can have.
session::PlayedFoci load_played_foci(const std::filesystem::path& file);

}  // namespace palpa::setup
