// The `palpa` command: the engine's subcommands, and those that the driver adds.
#include <dlfcn.h>

#include "cli/commands.hpp"
#include "driver/bench.hpp"
#include "driver/doctor.hpp"
#include "driver/emulate/command.hpp"
#include "driver/links.hpp"
#include "driver/sources.hpp"

namespace {

#ifdef PALPA_ADDRESS_SANITIZER
// The loader unloads lavapipe at teardown; leak reports would then name an unknown module that no suppression can
// match.
[[maybe_unused]] void* const keep_driver = dlopen("libvulkan_lvp.so", RTLD_LAZY | RTLD_NODELETE);
#endif

}  // namespace

int main(int argc, char** argv) {
  return palpa::cli::main(argc, argv,
                          {.doctor = palpa::driver::doctor_probes(),
                           .links = palpa::driver::links(),
                           .sources = palpa::driver::camera_sources(),
                           .commands = {palpa::driver::emulate::add_emulate},
                           .cameras = palpa::driver::cameras_there,
                           .benches = {palpa::driver::measure_links}});
}
