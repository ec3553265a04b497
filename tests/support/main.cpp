// main() of every test executable: says what it runs on and fails on any validation error.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "gpu/device.hpp"

namespace {

// The loader unloads lavapipe at teardown; leak reports would then name an unknown module that no suppression can
// match.
[[maybe_unused]] void* const keep_driver = dlopen("libvulkan_lvp.so", RTLD_LAZY | RTLD_NODELETE);

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  // No test leans on what an earlier one has computed.
  setenv("PALPA_CACHE", "off", 1);
  // Property tests draw the same cases on every run, so that what fails fails again and nobody's change fails by
  // chance. Whoever looks for more has RC_PARAMS.
  setenv("RC_PARAMS", "seed=20240601", 0);
  const int failed = RUN_ALL_TESTS();
  if (palpa::gpu::validation_errors() != 0) {
    std::fprintf(stderr, "FAILED: %llu Vulkan validation errors\n",
                 static_cast<unsigned long long>(palpa::gpu::validation_errors()));
    return 1;
  }
  return failed;
}
