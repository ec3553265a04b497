#include "viewer/app/scene_watch.hpp"

#include <system_error>
#include <utility>

namespace palpa::viewer {

bool SceneWatch::look(const std::string& file, double now_s) {
  constexpr double every_s = 1;
  if (now_s < next_s_) return false;
  next_s_ = now_s + every_s;
  if (file.empty()) return false;
  std::error_code fault;
  const std::filesystem::file_time_type time = std::filesystem::last_write_time(file, fault);
  if (fault) return false;
  const bool same_file = std::exchange(file_, file) == file;
  const bool written = std::exchange(time_, time) != time && same_file;
  const bool settled = same_file && !written && unsettled_;
  unsettled_ = written;
  return settled;
}

}  // namespace palpa::viewer
