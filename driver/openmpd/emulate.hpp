// `palpa emulate openmpd`: emulated boards behind sockets, in real time.
#pragma once

#include "base/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::openmpd {

/// One board for each serial number. Prints their addresses, a line each and nothing before them, what they report as
/// it happens, and at the end what they were shown. Throws failure() where there were violations, or boards of which
/// somebody let go got unequal numbers of frames.
void emulate(const emulate::Options& options, const Outputs& outputs);

}  // namespace palpa::driver::openmpd
