// Notices that the file of a scene has been written again.
#pragma once

#include <filesystem>
#include <string>

namespace palpa::viewer {

class SceneWatch {
 public:
  /// Looks at the file, at most once a second. Returns true if the file was written again and has not changed since the
  /// look before, because editors write in several steps. Returns false for an empty name, and for another file than at
  /// the last look, whose earlier state is not known.
  bool look(const std::string& file, double now_s);
  /// When to look again, on the clock of `now_s`.
  double next_s() const { return next_s_; }

 private:
  std::string file_;
  std::filesystem::file_time_type time_{};  ///< when it was written last
  bool unsettled_ = false;                  ///< it was written since the look before
  double next_s_ = 0;
};

}  // namespace palpa::viewer
