#include "sensing/joints/left_out.hpp"

#include <fmt/format.h>

#include "base/log.hpp"

namespace palpa::sensing {

LeftOut::~LeftOut() {
  for (const auto& [kind, count] : counts_) {
    if (count > 1) log::warning(fmt::format("{}: {} times, palpa left out {}", source_, count, kind));
  }
}

void LeftOut::add(const std::string& kind, const std::string& why) {
  const bool first = counts_[kind]++ == 0, other = !why.empty() && reasons_.writes(why);
  if (!first && !other) return;
  log::warning(fmt::format("{}: palpa leaves out {}{}{}", source_, kind, why.empty() ? "" : ": ", why));
}

}  // namespace palpa::sensing
