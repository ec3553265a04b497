// `palpa emulate sonicsurface`: emulated boards on a pseudo terminal, in real time.
#pragma once

#include "base/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::sonicsurface {

/// One board, or a primary and a secondary one where the layout has two. Prints the serial port's path, what the boards
/// find wrong as it happens, and at the end what they were told. Throws failure() where there were violations.
void emulate(const emulate::Options& options, const Outputs& outputs);

}  // namespace palpa::driver::sonicsurface
