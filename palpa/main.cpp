// The `palpa` command: the engine's subcommands, and what the driver adds to them.
#include "cli/commands.hpp"
#include "driver/doctor.hpp"

int main(int argc, char** argv) {
  return palpa::cli::main(argc, argv, {palpa::driver::doctor_probes()});
}
