#include "viewer/live/held_finger.hpp"

namespace palpa::viewer {

Transform HeldFinger::pose() const {
  const std::lock_guard lock(mutex_);
  return T_world_finger_;
}

void HeldFinger::put(const Transform& T_world_finger) {
  const std::lock_guard lock(mutex_);
  T_world_finger_ = T_world_finger;
}

bool HeldFinger::is_held(const std::string& source) {
  return source == "mouse" || source.starts_with("mouse:");
}

void HeldFinger::without_hand(line::Given& given) {
  constexpr std::size_t length = 5;  // of "mouse"
  const auto source = given.find("--source");
  if (source == given.end() || source->second.empty() || !is_held(source->second.front())) return;
  source->second.front().replace(0, length, "synthetic");
}

session::SourceKind HeldFinger::source() {
  return session::synthetic_source("mouse",
                                   "mouse[:MESH]: a rendered fingertip, or another mesh, that follows the pointer",
                                   [this](double) { return pose(); });
}

}  // namespace palpa::viewer
