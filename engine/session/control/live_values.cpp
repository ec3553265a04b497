#include "session/control/live_values.hpp"

#include <algorithm>

namespace palpa::session {

bool LiveValues::knows(std::string_view solid) {
  const std::lock_guard lock(mutex_);
  return std::ranges::find(names_, solid) != names_.end();
}

LiveValues::Named& LiveValues::values_of(std::string_view solid) {
  const auto found = std::ranges::find(values_, solid, &Named::solid);
  return found != values_.end() ? *found : values_.emplace_back(Named{.solid = std::string(solid), .values = {}});
}

void LiveValues::set_solids(std::span<const std::string> names) {
  const std::lock_guard lock(mutex_);  // nobody holds it for longer than a search by name
  names_.assign(names.begin(), names.end());
  again_ = true;
}

void LiveValues::apply(Session& session, RunObserver& observer) {
  if (!newest_.take() && !again_) return;
  const std::uint64_t known = again_ ? 0 : applied_;
  again_ = false;
  for (const Named& named : newest_.front()) {
    applied_ = std::max(applied_, named.change);
    if (named.change <= known) continue;
    for (std::uint32_t i = 0; i < session.solid_names().size(); ++i) {
      if (session.solid_names()[i] != named.solid) continue;
      if (!named.values.T_world_rest) continue;
      session.set_pose(i, *named.values.T_world_rest);
      observer.moved(i, *named.values.T_world_rest);
    }
  }
}

}  // namespace palpa::session
