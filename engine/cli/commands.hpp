// The engine's subcommands of `palpa`, and the main program.
#pragma once

#include "cli/command.hpp"

namespace palpa::cli {

void add_doctor(Program& program);
void add_touch(Program& program);
void add_drive(Program& program);
void add_field(Program& program);
void add_scatter(Program& program);
void add_simulate(Program& program);
void add_afferents(Program& program);
void add_run(Program& program);
void add_play(Program& program);
void add_export(Program& program);
void add_link(Program& program);
void add_calibrate(Program& program);
void add_decompose(Program& program);
void add_study(Program& program);
void add_bench(Program& program);

/// The whole program: parses, runs, reports; returns the exit code.
int main(int argc, const char* const* argv, const Extensions& extensions);

}  // namespace palpa::cli
