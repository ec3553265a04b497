#include "support/barriers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "gpu/watch.hpp"
#include "support/spirv.hpp"

namespace palpa::test {
namespace {

constexpr VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags2 indirect = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;

struct Use {
  const char *who = "", *what = "";  ///< a kernel, or what copies; the name of its buffer
  gpu::BufferRef buffer;
  Access access;
  VkPipelineStageFlags2 where = compute;
  VkPipelineStageFlags2 before = 0;  ///< stages that later barriers made wait for it
};

bool overlap(const gpu::BufferRef& a, const gpu::BufferRef& b) {
  const auto starts_in = [](const gpu::BufferRef& one, const gpu::BufferRef& other) {
    return one.offset >= other.offset && one.offset - other.offset < other.size;
  };
  return a.buffer == b.buffer && (starts_in(a, b) || starts_in(b, a));
}

/// Whether these two must not run side by side.
bool collide(const Use& a, const Use& b) {
  if (!overlap(a.buffer, b.buffer)) return false;
  const bool changed_a = a.access.writes || a.access.adds, changed_b = b.access.writes || b.access.adds;
  if ((changed_a && b.access.reads) || (a.access.reads && changed_b)) return true;
  if (!changed_a || !changed_b) return false;
  return std::string_view(a.who) != b.who || a.access.adds != b.access.adds;
}

/// Its memory is kept: tests count what a loop allocates.
struct Recording {
  std::vector<Use> uses;
  std::string_view last;  ///< the kernel of the last dispatch, if nothing was used since
};

class BarrierWatch : public gpu::Watch {
 public:
  void begins(VkCommandBuffer commands) override {
    const std::lock_guard lock(mutex_);
    Recording& recording = recordings_[commands];
    recording.uses.reserve(1024);
    recording.uses.clear();
    recording.last = {};
  }

  void dispatches(VkCommandBuffer commands, const gpu::KernelBuffers& buffers, const gpu::BufferRef* groups) override {
    const std::lock_guard lock(mutex_);
    const gpu::Kernel& kernel = *buffers.kernel;
    const auto [known, is_new] = accesses_.try_emplace(kernel.words.data());
    if (is_new) known->second = accesses_of(kernel);
    Recording& recording = recordings_[commands];
    const std::size_t before = recording.uses.size();
    if (groups)
      check(recording, before, {kernel.name, "the numbers of its groups", *groups, {.reads = true}, indirect});
    for (std::size_t i = 0; i < kernel.bindings.size(); ++i)
      check(recording, before, {kernel.name, kernel.bindings[i].name, buffers.refs[i], known->second[i]});
    recording.last = kernel.name;
  }

  void orders(VkCommandBuffer commands, VkPipelineStageFlags2 from, VkPipelineStageFlags2 to) override {
    const std::lock_guard lock(mutex_);
    Recording& recording = recordings_[commands];
    if (!left_out_.empty() && recording.last == left_out_) return;
    // A dispatch reads the numbers of its groups before it computes.
    const VkPipelineStageFlags2 first = (from & compute) != 0 ? from | indirect : from;
    for (Use& use : recording.uses) {
      if (((use.where | use.before) & first) != 0) use.before |= to;
    }
  }

  void uses(VkCommandBuffer commands, const char* who, const gpu::BufferRef& buffer, VkPipelineStageFlags2 where,
            bool writes) override {
    const std::lock_guard lock(mutex_);
    Recording& recording = recordings_[commands];
    check(recording, recording.uses.size(), {who, "a buffer", buffer, {.reads = !writes, .writes = writes}, where});
    recording.last = {};
  }

  void leave_out(const std::string& kernel) {
    const std::lock_guard lock(mutex_);
    left_out_ = kernel;
  }

 private:
  /// Keeps `now`, one of what a command does. `before`: the uses that earlier commands made.
  static void check(Recording& recording, std::size_t before, const Use& now) {
    const auto earlier = std::span(recording.uses).first(before);
    const auto missing = std::find_if(earlier.rbegin(), earlier.rend(), [&](const Use& use) {
      return (use.before & now.where) == 0 && collide(use, now);
    });
    if (missing != earlier.rend()) {
      throw failure(fmt::format("{} {} '{}', which {} {} as '{}', without a barrier between them", now.who,
                                now.access.reads ? "reads" : "writes", now.what, missing->who,
                                missing->access.writes || missing->access.adds ? "wrote" : "read", missing->what));
    }
    recording.uses.push_back(now);
  }

  std::mutex mutex_;
  std::string left_out_;
  std::map<VkCommandBuffer, Recording> recordings_;
  std::map<const std::uint32_t*, std::vector<Access>> accesses_;  ///< by the words of the kernel
};

BarrierWatch& the_watch() {
  static BarrierWatch watch;
  return watch;
}

}  // namespace

void watch_barriers() {
  gpu::watch = &the_watch();
}

NoBarrierAfter::NoBarrierAfter(const std::string& kernel) {
  the_watch().leave_out(kernel);
}

NoBarrierAfter::~NoBarrierAfter() {
  the_watch().leave_out({});
}

}  // namespace palpa::test
