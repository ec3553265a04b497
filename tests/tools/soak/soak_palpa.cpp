// The `palpa` command with the source `fed:`, for ./dev soak.
#include "cli/commands.hpp"
#include "driver/links.hpp"
#include "tools/soak/fed_cameras.hpp"

int main(int argc, char** argv) {
  return palpa::cli::main(argc, argv, {.links = palpa::driver::links(), .sources = {palpa::soak::fed_cameras()}});
}
