#include "base/activity.hpp"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace palpa {
namespace {

struct Activities {
  std::mutex mutex;
  std::vector<const Activity*> all;  ///< outermost first
};
Activities& activities() {
  static Activities instance;
  return instance;
}

thread_local const std::atomic<bool>* stop_of_thread = nullptr;

}  // namespace

Cancellable::Cancellable(const std::atomic<bool>& stop) {
  stop_of_thread = &stop;
}

Cancellable::~Cancellable() {
  stop_of_thread = nullptr;
}

const std::atomic<bool>* cancel_flag() {
  return stop_of_thread;
}

void stop_if_cancelled(const std::atomic<bool>* flag) {
  if (flag && *flag) throw failure("cancelled");
}

void Activity::advance(std::uint64_t steps) {
  stop_if_cancelled(stop_of_thread);
  done_.fetch_add(steps, std::memory_order_relaxed);
}

Activity::Activity(std::string what, std::uint64_t total) : what_(std::move(what)), total_(total) {
  if (stop_of_thread && *stop_of_thread) throw failure("cancelled before: " + what_);
  const std::lock_guard lock(activities().mutex);
  activities().all.push_back(this);
}

Activity::~Activity() {
  const std::lock_guard lock(activities().mutex);
  std::erase(activities().all, this);
}

std::optional<Doing> doing() {
  const std::lock_guard lock(activities().mutex);
  const std::vector<const Activity*>& all = activities().all;
  if (all.empty()) return std::nullopt;
  Doing now;
  for (const Activity* activity : all)
    now.what += (now.what.empty() ? "" : ": ") + activity->what_;
  now.total = all.back()->total_;
  now.done = std::min(now.total, all.back()->done_.load(std::memory_order_relaxed));
  return now;
}

}  // namespace palpa
