#include "cli/support/delays.hpp"

#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include "support/files.hpp"

namespace palpa::test {
namespace {

double sum_of(const std::map<std::string, double>& threads_s) {
  double sum_s = 0;
  for (const auto& [thread, delay_s] : threads_s)
    sum_s += delay_s;
  return sum_s;
}

}  // namespace

Delays::Delays(std::vector<pid_t> processes) : processes_(std::move(processes)) {
  look();
  before_s_ = sum_of(threads_s_);
}

void Delays::look() {
  for (const pid_t process : processes_) {
    std::error_code gone;
    std::filesystem::directory_iterator thread("/proc/" + std::to_string(process) + "/task", gone);
    for (; !gone && thread != std::filesystem::directory_iterator(); thread.increment(gone)) {
      std::istringstream schedstat(read_text(thread->path() / "schedstat"));
      double ran_ns = 0, delayed_ns = 0;
      if (schedstat >> ran_ns >> delayed_ns) threads_s_[thread->path().filename()] = 1e-9 * delayed_ns;
    }
  }
}

double Delays::sum_s() const {
  return sum_of(threads_s_) - before_s_;
}

}  // namespace palpa::test
