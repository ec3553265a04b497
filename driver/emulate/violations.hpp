// Violations of the rules of an emulated device, as its emulator finds them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpa::driver::emulate {

struct Violation {
  double time_s = 0;
  std::string what;
};

/// The first violations, and how many there were.
class Violations {
 public:
  static constexpr std::size_t most_kept = 20;
  void add(double time_s, std::string what) {
    ++count_;
    if (kept_.size() == most_kept) return;
    Violation& violation = kept_.emplace_back();
    violation.time_s = time_s;
    violation.what = std::move(what);
  }
  std::size_t count() const { return count_; }
  const std::vector<Violation>& kept() const { return kept_; }

 private:
  std::vector<Violation> kept_;
  std::size_t count_ = 0;
};

/// The same, with times counted from `begin_s`.
inline std::vector<Violation> since(double begin_s, std::span<const Violation> all) {
  std::vector<Violation> out(all.begin(), all.end());
  for (Violation& violation : out)
    violation.time_s -= begin_s;
  return out;
}

}  // namespace palpa::driver::emulate
