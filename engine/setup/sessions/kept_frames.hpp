// A source that keeps some of its frames, evenly over all that came: what a run saw, for the time after it.
#pragma once

#include <cstdint>
#include <vector>

#include "sensing/depth_source.hpp"

namespace palpa::setup {

class KeptFrames final : public sensing::DepthSource {
 public:
  /// The source must outlive it.
  explicit KeptFrames(sensing::DepthSource& source) : source_(&source) {}

  const std::vector<sensing::Camera>& cameras() const override { return source_->cameras(); }
  bool next(sensing::FrameSet& out, double timeout_s) override {
    if (!source_->next(out, timeout_s)) return false;
    if (out.came()) keep(out);
    return true;
  }
  /// All frames if there are at most 7; otherwise 4 to 7 of them, at equal distances.
  const std::vector<sensing::FrameSet>& frames() const { return kept_; }

 private:
  static constexpr std::size_t most = 8;
  /// Every `apart_`-th frame. If there is no room, only every other one stays.
  void keep(const sensing::FrameSet& set) {
    if (came_++ % apart_ != 0) return;
    kept_.push_back(set);
    if (kept_.size() < most) return;
    for (std::size_t i = 1; i < most / 2; ++i)
      kept_[i] = std::move(kept_[2 * i]);
    kept_.resize(most / 2);
    apart_ *= 2;
  }

  sensing::DepthSource* source_;
  std::vector<sensing::FrameSet> kept_;
  std::uint64_t came_ = 0, apart_ = 1;
};

}  // namespace palpa::setup
