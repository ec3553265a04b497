// `palpa simulate`: its options, and the paper's figure of several touches.
#pragma once

#include "setup/tasks/lines.hpp"

namespace palpa::cli {

using SimulateCommand = setup::SimulateLine;

/// The finger given by --finger, for the air of the options.
setup::FingerBody load_finger(const SimulateCommand& o);

/// The paper's objects, one after the other, with every method: table, --json, --png.
void run_figure6(const SimulateCommand& o);

}  // namespace palpa::cli
