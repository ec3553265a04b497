#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>
#include <thread>

#include "base/error.hpp"
#include "sensing/synthetic.hpp"

namespace palpa::sensing {
namespace {

using Clock = std::chrono::steady_clock;

class SyntheticSource : public DepthSource {
 public:
  SyntheticSource(std::vector<Camera> cameras, geometry::Mesh skin, const geometry::Mesh& occluders,
                  SyntheticOptions options)
      : rig_(std::move(cameras), occluders, options.noise, options.seed, options.occluders_name),
        skin_(std::move(skin)),
        options_(std::move(options)) {
    if (options_.rate_hz <= 0 && !rig_.cameras().empty()) options_.rate_hz = rig_.cameras().front().rate_hz;
    if (options_.rate_hz <= 0) options_.rate_hz = 90;
  }

  const std::vector<Camera>& cameras() const override { return rig_.cameras(); }

  bool next(FrameSet& out, double timeout_s) override {
    if (options_.paced) {
      if (!started_) start_ = Clock::now();
      started_ = true;
      const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
      // A late caller gets the newest frame, as from a camera.
      next_ = std::max(next_, static_cast<std::uint64_t>(elapsed * options_.rate_hz));
      const double wait = static_cast<double>(next_) / options_.rate_hz - elapsed;
      if (ended()) return false;
      std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(wait, 0.0, std::max(timeout_s, 0.0))));
      if (wait > timeout_s) {
        out.frames.clear();
        return true;
      }
    }
    if (ended()) return false;
    const double time_s = static_cast<double>(next_) / options_.rate_hz;
    const Posed posed{&skin_, options_.motion(time_s), options_.skin_name};
    rig_.render(std::span(&posed, 1), next_, out);
    for (DepthFrame& frame : out.frames)
      frame.time_s = time_s;
    out.time_s = time_s;
    ++next_;
    return true;
  }

 private:
  bool ended() const { return options_.frames && next_ >= *options_.frames; }

  SyntheticRig rig_;
  geometry::Mesh skin_;
  SyntheticOptions options_;
  std::uint64_t next_ = 0;
  bool started_ = false;
  Clock::time_point start_;
};

}  // namespace

Transform dipping_motion(double time_s) {
  const auto wave = [&](double period_s) {
    return std::sin(2 * std::numbers::pi * std::fmod(time_s, period_s) / period_s);
  };
  return glm::translate(Transform(1.0), Vec3(0.003 * wave(3.1), -0.004 * wave(2), 0.003 * wave(4.3)));
}

std::unique_ptr<DepthSource> make_synthetic_source(std::vector<Camera> cameras, geometry::Mesh skin,
                                                   const geometry::Mesh& occluders, SyntheticOptions options) {
  if (cameras.empty()) throw bad_usage("a synthetic rig needs a camera");
  return std::make_unique<SyntheticSource>(std::move(cameras), std::move(skin), occluders, std::move(options));
}

}  // namespace palpa::sensing
