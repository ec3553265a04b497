// `palpa emulate autd3`: an emulated server with its devices, in real time.
#pragma once

#include "base/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::autd3 {

/// One device per board of the layout. Prints the address, what the server finds wrong as it happens, and at the end
/// what it was told. Throws failure() where there were violations.
void emulate(const emulate::Options& options, const Outputs& outputs);

}  // namespace palpa::driver::autd3
