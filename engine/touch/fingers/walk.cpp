#include "touch/fingers/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace palpa::touch {
namespace {

/// The pixels from one to another in equal steps, rounded to the nearest, halves up.
class PixelSteps {
 public:
  PixelSteps(int from, int to, int steps) : pixel_(from), rest_(steps), parts_(2 * steps) {
    const int way = 2 * (to - from);
    whole_ = way / parts_ - (way % parts_ < 0 ? 1 : 0);
    part_ = way - whole_ * parts_;
  }
  std::uint32_t next() {
    const int pixel = pixel_;
    pixel_ += whole_;
    rest_ += part_;
    if (rest_ >= parts_) {
      rest_ -= parts_;
      ++pixel_;
    }
    return static_cast<std::uint32_t>(pixel);
  }

 private:
  int pixel_, rest_;  // the place is pixel_ + rest_ / parts_ - 1/2
  int parts_, whole_, part_;
};

/// A walk over the picture from one sample to another: the skin's height towards the camera, above the straight line
/// between the two. It looks for a valley.
class Walk {
 public:
  Walk(const SeenSample& a, const SeenSample& b) : a_(a), b_(b) {
    steps_ = std::min(std::max(std::abs(b.u - a.u), std::abs(b.v - a.v)), most_steps);
    const glm::vec3 way = b.at - a.at;
    const float lateral = way.x * way.x + way.y * way.y;
    const float square = glm::dot(way, way);
    tilt_ = square > 0 ? std::sqrt(lateral / square) : 0;
    least_ = noise_at(std::max(a.at.z, b.at.z));
    stride_ = steps_ > 0 ? std::sqrt(lateral) / static_cast<float>(steps_) : 0;
  }

  bool finds_valley(const Sight& sight, std::size_t c) {
    if (steps_ == 0) return false;
    const SightCamera& camera = sight.cameras[c];
    const std::array<float, most_steps + 1> line = line_depths();
    PixelSteps u(a_.u, b_.u, steps_), v(a_.v, b_.v, steps_);
    for (int step = 0; step <= steps_ && state_ != State::valley; ++step) {
      const std::uint32_t raw = raw_at(sight, c, u.next(), v.next());
      if (raw < camera.first_depth) {
        pass_hole();
      } else {
        pass((line[static_cast<std::size_t>(step)] - static_cast<float>(raw) * camera.depth_unit) * tilt_);
      }
    }
    return state_ == State::valley;
  }

 private:
  static constexpr int most_steps = 64;
  enum class State {
    begun,
    one,     ///< one height is known
    top,     ///< `level_` is the highest
    bottom,  ///< it has fallen by `least_`; `level_` is the lowest height since
    valley,  ///< it has risen again by as much
  };

  /// Depths of the straight line, step by step.
  std::array<float, most_steps + 1> line_depths() const {
    std::array<float, most_steps + 1> depths;
    const float a = a_.at.z, b = b_.at.z, steps = static_cast<float>(steps_);
    for (int step = 0; step <= most_steps; ++step)
      depths[static_cast<std::size_t>(step)] = a * b / (b + static_cast<float>(step) / steps * (a - b));
    return depths;
  }

  /// A gap without data also counts as a valley if it is wide.
  void pass_hole() {
    hole_ += stride_;
    if (hole_ < 2e-3F || state_ >= State::bottom) return;
    state_ = State::bottom;
    level_ = -1;
  }

  /// The height at the next place of which the camera has data. Only two consecutive places make a height or a depth,
  /// so a single pixel does not.
  void pass(float height) {
    const float high = std::min(before_, height), low = std::max(before_, height);
    before_ = height;
    hole_ = 0;
    switch (state_) {
      case State::begun:
        state_ = State::one;
        break;
      case State::one:
        level_ = high;
        state_ = State::top;
        break;
      case State::top:
        level_ = std::max(level_, high);
        if (level_ - low < least_) break;
        level_ = low;
        state_ = State::bottom;
        break;
      case State::bottom:
        level_ = std::min(level_, low);
        if (high - level_ >= least_) state_ = State::valley;
        break;
      case State::valley:
        break;
    }
  }

  const SeenSample &a_, &b_;
  int steps_;
  State state_ = State::begun;
  float tilt_;   ///< the part of a difference in depth that is across the line
  float least_;  ///< depth of a valley
  float stride_;
  float level_ = 0;
  float before_ = 0;  ///< the height before
  float hole_ = 0;    ///< width of the hole that the walk is in
};

}  // namespace

SeenSample seen_sample(const Sight& sight, std::size_t c, const glm::vec3& place) {
  const SightCamera& camera = sight.cameras[c];
  const Appearance a = appearance(camera, place);
  const std::uint32_t raw = raw_at(sight, c, a.u, a.v);
  const float step = static_cast<float>(raw) * camera.depth_unit - a.depth;
  return {seen_from(camera, place), static_cast<int>(a.u), static_cast<int>(a.v),
          a.depth > 0 && raw >= camera.first_depth && std::abs(step) <= surface_step_m};
}

bool finds_valley(const Sight& sight, std::size_t camera, const SeenSample& a, const SeenSample& b) {
  return Walk(a, b).finds_valley(sight, camera);
}

}  // namespace palpa::touch
