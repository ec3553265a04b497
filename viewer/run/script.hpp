// Plays a script, picture by picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/files/outputs.hpp"
#include "viewer/options/viewer_options.hpp"
#include "viewer/run/interact.hpp"

namespace palpa::viewer {

class Script {
 public:
  /// The script of --interact; without it, there is nothing to play. Throws bad_input, and bad_usage for a shot in a
  /// window.
  explicit Script(const ViewerOptions& options);
  explicit Script(std::vector<Interaction> steps) : steps_(std::move(steps)) {}

  /// The files that its shots write, each once.
  std::vector<Output> outputs() const;

  bool busy() const { return next_ < steps_.size() || pictures_ > 0 || until_s_; }
  /// Passes events, sizes and shots to `act` until pictures must be drawn or time must pass.
  void play(double now_s, const std::function<void(const Interaction&)>& act);
  /// Call when a picture was drawn.
  void drew() { pictures_ -= pictures_ > 0 ? 1 : 0; }

 private:
  std::vector<Interaction> steps_;
  std::size_t next_ = 0;
  std::uint32_t pictures_ = 0;
  std::optional<double> until_s_;
};

}  // namespace palpa::viewer
