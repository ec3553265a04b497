#include "base/sparing.hpp"

namespace palpa {

bool Sparing::writes(const std::string& text, Clock::time_point now) {
  if (now - second_ >= std::chrono::seconds(1)) {
    second_ = now;
    in_second_ = 0;
  }
  if (in_second_ == most_in_second || written_.size() == most_in_all || !written_.insert(text).second) return false;
  ++in_second_;
  return true;
}

}  // namespace palpa
