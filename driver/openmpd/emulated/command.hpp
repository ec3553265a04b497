// `palpa emulate openmpd`: emulated boards behind sockets, in real time.
#pragma once

#include "base/files/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::openmpd {

/// Emulates one board for each serial number. Prints their addresses, one line each and nothing before them, then their
/// reports as they happen, and at the end what they were shown. Throws failure() if there were violations, or if boards
/// that a program has released got unequal numbers of frames.
void emulate(const emulate::Options& options, const Outputs& outputs);

}  // namespace palpa::driver::openmpd
