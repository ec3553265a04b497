// What computes: the command line, the environment, or what the machine has, in this order.
#include <gtest/gtest.h>

#include "setup/compute.hpp"
#include "support/thrown.hpp"

namespace palpa::setup::test {
namespace {

using Found = std::optional<std::string>;

UsedBackend chosen(const ComputeOptions& options, std::string_view environment, const Found& gpu) {
  return choose_backend(options, environment, [&] { return gpu; });
}

TEST(Backend, TakesAGpuWhereThereIsOne) {
  const UsedBackend gpu = chosen({}, "", "Quick Card");
  EXPECT_EQ(gpu.backend, Backend::gpu);
  EXPECT_EQ(gpu.why, "there is a GPU, Quick Card");
  const UsedBackend cpu = chosen({}, "", {});
  EXPECT_EQ(cpu.backend, Backend::cpu);
  EXPECT_EQ(cpu.why, "there is no GPU");
}

TEST(Backend, IsTheOneThatIsNamed) {
  for (const Found& gpu : {Found("Quick Card"), Found()}) {
    EXPECT_EQ(chosen({.backend = Backend::cpu}, "gpu", gpu).backend, Backend::cpu);
    EXPECT_EQ(chosen({.backend = Backend::gpu}, "cpu", gpu).why, "--backend gpu was given");
    EXPECT_EQ(chosen({}, "cpu", gpu).why, "PALPA_BACKEND is cpu");
    EXPECT_EQ(chosen({}, "gpu", gpu).backend, Backend::gpu);
    EXPECT_EQ(chosen({}, "auto", gpu).backend, gpu ? Backend::gpu : Backend::cpu);
  }
}

TEST(Backend, OptionsOfAGpuImplyIt) {
  EXPECT_EQ(chosen({.gpu = "llvmpipe"}, "cpu", {}).why, "--gpu was given");
  EXPECT_EQ(chosen({.validation = gpu::Validation::core}, "cpu", {}).why, "--validation was given");
}

TEST(Backend, LooksForAGpuOnlyIfNothingElseDecides) {
  const auto never = []() -> Found {
    ADD_FAILURE() << "looked";
    return {};
  };
  choose_backend({.backend = Backend::gpu}, "", never);
  choose_backend({.gpu = "0"}, "", never);
  choose_backend({}, "cpu", never);
}

TEST(Backend, RefusesAnEnvironmentThatNamesNone) {
  EXPECT_ERROR(chosen({}, "cuda", {}), Exit::usage, "PALPA_BACKEND is 'cuda': give auto, gpu or cpu");
}

}  // namespace
}  // namespace palpa::setup::test
