#include <gtest/gtest.h>

#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <thread>
#include <tuple>

#include "base/error.hpp"
#include "base/system/now.hpp"
#include "gpu/barrier.hpp"
#include "gpu/buffer.hpp"
#include "gpu/check.hpp"
#include "gpu/commands.hpp"
#include "gpu/device.hpp"
#include "gpu/timestamps.hpp"
#include "support/device.hpp"
#include "support/thrown.hpp"

namespace palpa::gpu {
namespace {

TEST(Device, ListsWhatIsThere) {
  const auto devices = list_devices();
  ASSERT_FALSE(devices.empty());
  for (std::size_t i = 0; i < devices.size(); ++i)
    EXPECT_EQ(devices[i].index, i);
  RecordProperty("device", test::test_device().description().name);
  std::printf("device: %s, driver %s\n", test::test_device().description().name.c_str(),
              test::test_device().description().driver.c_str());
}

TEST(Device, IsChosenByIndexAndByPartOfItsNameInAnyCase) {
  const DeviceDescription wanted = test::test_device().description();
  EXPECT_EQ(Device({.select = std::to_string(wanted.index)}).description().name, wanted.name);
  std::string part = wanted.name.substr(0, 4);
  for (char& c : part)
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_NE(Device({.select = part}).description().name, "");
}

TEST(Device, RefusesWithAReasonWhenNothingFits) {
  EXPECT_ERROR(Device({.select = "no such GPU"}), Exit::no_device, "is not 'no such GPU'");
  EXPECT_ERROR(Device({.select = "999"}), Exit::no_device, "999");
}

TEST(Device, StagedAndUnifiedBuffersCarryTheSameBytes) {
  for (const bool staging : {false, true}) {
    const Device device({.force_staging = staging});
    EXPECT_FALSE(staging && device.unified_memory());
    Upload upload(device, 1000, "up");
    Readback readback(device, 1000, "down");
    EXPECT_EQ(upload.ref().size, 1000u);
    for (int i = 0; i < 1000; ++i)
      upload.data()[i] = static_cast<std::byte>(i * 7);
    const Recorder recorder(device, "copy");
    Timeline timeline(device);
    const VkCommandBuffer commands = recorder.begin();
    upload.record(commands);
    const VkBufferCopy region{0, 0, 1000};
    vkCmdCopyBuffer(commands, upload.ref().buffer, readback.ref().buffer, 1, &region);
    readback.record(commands);
    const std::uint64_t value = timeline.submit(recorder.end());
    timeline.wait(value);
    EXPECT_TRUE(timeline.done(value));
    EXPECT_EQ(std::memcmp(upload.data(), readback.data(), 1000), 0) << "staging " << staging;
  }
}

// The driver's own functions would not work for another driver's device. And a thread that calls one must not collide
// with a thread that loads them.
TEST(Device, FunctionsAreTheLoadersAndLoadedOnce) {
  const Device device;
  const auto all = [] {
    return std::tuple(vkCmdDispatch, vkQueueSubmit, vkCmdPushDescriptorSetKHR, vkGetPhysicalDeviceProperties,
                      vkSetDebugUtilsObjectNameEXT);
  };
  const auto before = all();
  EXPECT_EQ(reinterpret_cast<PFN_vkVoidFunction>(vkCmdDispatch),
            vkGetInstanceProcAddr(device.instance(), "vkCmdDispatch"));
  EXPECT_NE(reinterpret_cast<PFN_vkVoidFunction>(vkCmdDispatch), vkGetDeviceProcAddr(device.get(), "vkCmdDispatch"));
  std::atomic<bool> done{false};
  std::thread lists([&] {
    while (!done)
      list_devices();
  });
  Buffer buffer(device, 320, "filled");
  const Recorder recorder(device, "fill");
  Timeline timeline(device);
  for (VkDeviceSize i = 0; i < 20; ++i) {
    vkCmdFillBuffer(recorder.begin(), buffer.ref().buffer, 16 * i, 16, 7);
    timeline.wait(timeline.submit(recorder.end()));
  }
  done = true;
  lists.join();
  const Device another;
  EXPECT_EQ(all(), before);
}

// As in the viewer, whose run begins on a separate thread. With Debian 13's loader, it crashed.
TEST(Device, NamesItsObjectsWhileOtherThreadsMakeInstances) {
  const Device& device = test::test_device();
  std::atomic<bool> done{false};
  std::thread names([&] {
    while (!done)
      const Buffer buffer(device, 64, "named");
  });
  for (int i = 0; i < 12; ++i)
    EXPECT_FALSE(list_devices().empty());
  done = true;
  names.join();
}

/// An event that is not signalled.
VkEvent event_of(const Device& device) {
  VkEvent event = VK_NULL_HANDLE;
  const VkEventCreateInfo info{VK_STRUCTURE_TYPE_EVENT_CREATE_INFO};
  PALPA_VK(vkCreateEvent(device.get(), &info, nullptr, &event));
  return event;
}
void wait_for(VkCommandBuffer commands, VkEvent event) {
  vkCmdWaitEvents(commands, 1, &event, VK_PIPELINE_STAGE_HOST_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, nullptr, 0,
                  nullptr, 0, nullptr);
}

TEST(Timeline, ASubmitOfNothingIsDoneWhenAllBeforeItIs) {
  const char* const validation = std::getenv("PALPA_VALIDATION");
  if (validation && std::string_view(validation) == "gpu-assisted")
    GTEST_SKIP() << "this validation waits for a queue before its host may signal an event";
  const Device& device = palpa::test::test_device();
  const VkEvent later = event_of(device);
  const Handle<VkEvent> owner(device.get(), later, vkDestroyEvent);
  const Recorder recorder(device, "waits");
  Timeline work(device), drained(device);
  const VkCommandBuffer commands = recorder.begin();
  wait_for(commands, later);
  const std::uint64_t busy = work.submit(recorder.end()), end = drained.submit();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(drained.done(end));
  PALPA_VK(vkSetEvent(device.get(), later));
  drained.wait(end);
  EXPECT_TRUE(work.done(busy));
}

TEST(Device, ALostDeviceIsAnErrorNotACrash) {
  const Device device;
  const Recorder recorder(device, "lost");
  Timeline timeline(device);
  recorder.begin();
  const VkCommandBuffer commands = recorder.end();
  device.lose();
  EXPECT_ERROR(timeline.submit(commands), Exit::failed, "VK_ERROR_DEVICE_LOST");
}

/// Waits for a device whose work never ends, and abandons it.
[[noreturn]] void use_a_device_that_does_not_answer() {
  bool told = false, told_again_at_once = false;
  {
    const Device device;
    const Buffer buffer(device, 1 << 16, "in use");
    const Recorder recorder(device, "for ever");
    Timeline timeline(device);
    const VkCommandBuffer commands = recorder.begin();
    wait_for(commands, event_of(device));
    vkCmdFillBuffer(commands, buffer.ref().buffer, 0, VK_WHOLE_SIZE, 7);
    const std::uint64_t value = timeline.submit(recorder.end());
    const auto is_copied = [&](double patience_s, const std::string& part) {
      const Error error = palpa::test::thrown_by([&] { timeline.wait(value, patience_s); });
      return std::string(error.what()).find(part) != std::string::npos;
    };
    told = is_copied(0.2, "no answer within 0.2 s");
    told_again_at_once = is_copied(60, "does not answer");
  }
  std::_Exit(told && told_again_at_once ? 0 : 1);
}

TEST(Timeline, ADeviceThatDoesNotAnswerIsLeftAlone) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(use_a_device_that_does_not_answer(), testing::ExitedWithCode(0), "");
}

TEST(Device, ChecksNameCallFileAndResult) {
  const std::string line = test::thrown_by([] { PALPA_VK(VK_ERROR_OUT_OF_DEVICE_MEMORY); }).what();
  EXPECT_CONTAINS(line, "VK_ERROR_OUT_OF_DEVICE_MEMORY");
  EXPECT_CONTAINS(line, "test_device.cpp:");
  EXPECT_NO_THROW(PALPA_VK(VK_SUBOPTIMAL_KHR));
}

TEST(Device, KnowsItsValidationPresets) {
  EXPECT_EQ(value_of(validation_words, "sync"), Validation::sync);
  EXPECT_EQ(value_of(validation_words, "gpu-assisted"), Validation::gpu_assisted);
  EXPECT_EQ(value_of(validation_words, "best"), std::nullopt);
}

TEST(Timestamps, AddUpByNameNeverRunBackwardsAndLieWithinTheSubmit) {
  Device& device = test::test_device();
  Timestamps timestamps(device, 4);
  const Buffer buffer(device, 1 << 20, "filled");
  const Recorder recorder(device, "timed");
  Timeline timeline(device);
  const VkCommandBuffer commands = recorder.begin();
  timestamps.begin(commands);
  for (const char* name : {"fill", "fill", "other"}) {
    vkCmdFillBuffer(commands, buffer.ref().buffer, 0, VK_WHOLE_SIZE, 7);
    writes_to_transfer(commands);
    timestamps.mark(commands, name);
  }
  const double begin_ms = now_ms();
  timeline.wait(timeline.submit(recorder.end()));
  const double elapsed_ms = now_ms() - begin_ms;
  std::vector<PassTime> times;
  timestamps.read(times);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_STREQ(times[0].name, "fill");
  EXPECT_STREQ(times[1].name, "other");
  double sum_ms = 0;
  for (const PassTime& time : times) {
    EXPECT_GE(time.ms, 0.0);
    sum_ms += time.ms;
  }
  EXPECT_LE(sum_ms, elapsed_ms);
}

}  // namespace
}  // namespace palpa::gpu
