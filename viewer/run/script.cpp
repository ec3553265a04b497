#include "viewer/run/script.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"

namespace palpa::viewer {

Script::Script(const ViewerOptions& options) {
  if (options.interact.empty()) return;
  steps_ = load_interactions(options.interact);
  const auto shot = std::ranges::find(steps_, Interaction::Kind::shot, &Interaction::kind);
  if (shot != steps_.end() && !options.headless)
    throw bad_usage("--interact: " + options.interact + ":" + std::to_string(shot->line) +
                    ": shot goes with --headless");
}

std::vector<Output> Script::outputs() const {
  std::vector<Output> outputs;
  for (const Interaction& step : steps_) {
    if (step.kind != Interaction::Kind::shot) continue;
    if (std::ranges::find(outputs, step.file, &Output::target) != outputs.end()) continue;
    outputs.push_back({fmt::format("shot in line {} of --interact", step.line), step.file});
  }
  return outputs;
}

void Script::play(double now_s, const std::function<void(const Interaction&)>& act) {
  if (pictures_ > 0 || (until_s_ && now_s < *until_s_)) return;
  until_s_.reset();
  while (next_ < steps_.size()) {
    const Interaction& step = steps_[next_++];
    if (step.kind == Interaction::Kind::draw) {
      pictures_ = step.count;
      return;
    }
    if (step.kind == Interaction::Kind::wait) {
      until_s_ = now_s + step.seconds;
      return;
    }
    act(step);
  }
}

}  // namespace palpa::viewer
