// `palpa emulate autd3-udp`.
#pragma once

#include <string>

#include "base/files/outputs.hpp"
#include "driver/emulate/command.hpp"

namespace palpa::driver::autd3_udp {

/// Emulates a chain of units on ::1 until a signal, with one socket for the group and one for each unit.
void emulate(const emulate::Options& options, const Outputs& outputs);

/// Throws bad_usage for an invalid `--fault`.
void check_fault(const std::string& text);

}  // namespace palpa::driver::autd3_udp
