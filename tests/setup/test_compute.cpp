// What computes: the command line, the environment, or what the machine has, in this order.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "gpu/device.hpp"
#include "setup/options/compute.hpp"
#include "support/thrown.hpp"

namespace palpa::setup {
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
    EXPECT_EQ(chosen({.backend = Backend::gpu}, "cpu", gpu).why, "the backend gpu was asked for");
    EXPECT_EQ(chosen({}, "cpu", gpu).why, "PALPA_BACKEND is cpu");
    EXPECT_EQ(chosen({}, "gpu", gpu).backend, Backend::gpu);
    EXPECT_EQ(chosen({}, "auto", gpu).backend, gpu ? Backend::gpu : Backend::cpu);
  }
}

TEST(Backend, OptionsOfAGpuImplyIt) {
  EXPECT_EQ(chosen({.gpu = "llvmpipe"}, "cpu", {}).why, "a GPU was named");
  EXPECT_EQ(chosen({.validation = gpu::Validation::core}, "cpu", {}).why, "validation was asked for");
  EXPECT_EQ(chosen({.validation = gpu::Validation::off}, "", {}).backend, Backend::cpu);
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

TEST(Backend, TheBestDeviceIsTheFirstUsableOneOfTheFastestKind) {
  const auto device = [](const char* name, const char* kind, const char* unusable = "") {
    return gpu::DeviceDescription{.name = name, .kind = kind, .unusable = unusable};
  };
  const auto best = [](const std::vector<gpu::DeviceDescription>& devices) {
    const gpu::DeviceDescription* found = gpu::best_of(devices);
    return found ? found->name : "none";
  };
  EXPECT_EQ(best({}), "none");
  EXPECT_EQ(best({device("old", "discrete", "offers Vulkan 1.1")}), "none");
  EXPECT_EQ(best({device("soft", "cpu"), device("small", "integrated"), device("large", "discrete")}), "large");
  EXPECT_EQ(best({device("odd", "other"), device("soft", "cpu")}), "soft");
  EXPECT_EQ(best({device("old", "discrete", "offers Vulkan 1.1"), device("soft", "cpu"), device("again", "cpu")}),
            "soft");
}

TEST(Backend, KeepsADeviceUntilItIsLost) {
  const ComputeOptions options{.backend = Backend::gpu};
  const gpu::Device* const first = kept_device(options);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(kept_device(options), first);
  EXPECT_EQ(kept_device({.backend = Backend::cpu}), nullptr);
  first->lose();
  const gpu::Device* const next = kept_device(options);
  ASSERT_NE(next, nullptr);
  EXPECT_FALSE(next->lost());
  EXPECT_EQ(kept_device(options), next);
  EXPECT_TRUE(first->lost()) << "others may still have it";
  const std::unique_ptr<const gpu::Device> nobody_has_it(first);
}

TEST(Backend, RefusesAnEnvironmentThatNamesNoBackend) {
  EXPECT_ERROR(chosen({}, "cuda", {}), Exit::usage, "PALPA_BACKEND is 'cuda': give auto, gpu or cpu");
}

}  // namespace
}  // namespace palpa::setup
