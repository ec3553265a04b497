// `palpa emulate sonicsurface`: emulated boards on a pseudo terminal, in real time.
#pragma once

#include "base/files/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::sonicsurface {

/// Emulates one board, or a primary and a secondary one if the layout has two. Prints the serial port's path, errors as
/// the boards find them, and at the end what the boards were sent. Throws failure() if there were violations.
void emulate(const emulate::Options& options, const Outputs& outputs);

}  // namespace palpa::driver::sonicsurface
