// For how long a busy machine keeps programs waiting for a processor.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

namespace palpa::test {

class Delays {
 public:
  /// Counts from now on, for all threads of these processes.
  explicit Delays(std::vector<pid_t> processes);
  /// Must be called often: the count of a thread that has ended stays as it was at the last look.
  void look();
  /// Until the last look, in all threads together: the time in which a thread was ready and got no processor.
  double sum_s() const;

 private:
  std::vector<pid_t> processes_;
  std::map<std::string, double> threads_s_;  ///< since each thread's start
  double before_s_ = 0;
};

/// From so much on, a program that a signal ends may tell that it did not get everything done in the second it has.
constexpr double delay_that_is_told_s = 0.05;

}  // namespace palpa::test
