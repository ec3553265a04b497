// `palpa emulate autd3`: an emulated server with its devices, in real time.
#pragma once

#include "base/files/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::autd3 {

/// Emulates one device per board of the layout. Prints the address, errors as the server finds them, and at the end
/// what the server was sent. Throws failure() if there were violations.
void emulate(const emulate::Options& options, const Outputs& outputs);

}  // namespace palpa::driver::autd3
