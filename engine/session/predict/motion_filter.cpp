#include "session/predict/motion_filter.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::session {
namespace {

constexpr double least_sigma_m = 0.1e-3;
constexpr double first_speed = 1;  ///< standard deviation of a coordinate of the velocity of a finger that is new, m/s
constexpr double q2 = 0.4 * 0.4;   ///< m^2 s^-3
constexpr double gate = 12;
/// The least share of q2; the number of frames in which the share shrinks to 1/e if nothing surprises; and the squared
/// surprise, relative to what is expected, that makes it 1 again.
constexpr double least_share = 0.02, frames_of_calm = 4, jolt = 5;

double square(double value) {
  return value * value;
}

}  // namespace

MotionFilter::MotionFilter(double noise_m) : sigma2_(square(std::max(noise_m, least_sigma_m))) {}

void MotionFilter::see(double time_s, const Vec3& place_m, bool tracked) {
  tracked_ = tracked;
  const double dt = time_s - time_s_;
  if (!known_ || dt < 0 || dt > longest_pause_s) {
    known_ = true;
    time_s_ = time_s;
    place_ = place_m;
    velocity_ = Vec3(0);
    pxx_ = sigma2_;
    pxv_ = 0;
    pvv_ = square(first_speed);
    share_ = 1;
    return;
  }
  time_s_ = time_s;
  place_ += velocity_ * dt;
  pxx_ += dt * (2 * pxv_ + dt * pvv_);
  pxv_ += dt * pvv_;
  accelerate(share_ * q2, dt);
  const Vec3 surprise = place_m - place_;
  const double relative = glm::dot(surprise, surprise) / (3 * (pxx_ + sigma2_));
  if (relative > jolt) {
    accelerate((1 - share_) * q2, dt);
    share_ = 1;
  } else if (tracked) {
    share_ = std::clamp(share_ * std::exp((relative - 1) / frames_of_calm), least_share, 1.0);
  }
  const double kx = pxx_ / (pxx_ + sigma2_), kv = pxv_ / (pxx_ + sigma2_);
  place_ += surprise * kx;
  velocity_ += surprise * kv;
  pvv_ -= kv * pxv_;
  pxv_ -= kv * pxx_;
  pxx_ -= kx * pxx_;
}

void MotionFilter::accelerate(double density, double dt) {
  pxx_ += density * dt * dt * dt / 3;
  pxv_ += density * dt * dt / 2;
  pvv_ += density * dt;
}

Vec3 MotionFilter::velocity() const {
  if (!known_) return Vec3(0);
  const double speed2 = glm::dot(velocity_, velocity_);
  if (!(speed2 > 0)) return Vec3(0);
  const double noise = square(gate * pvv_ / speed2), open = 1 / (1 + (tracked_ ? square(noise) : noise));
  const double gain = 1 - 0.1 * share_;
  const double speed = std::sqrt(speed2) * gain * open;
  return velocity_ * (gain * open * std::min(1.0, most_speed / std::max(speed, 1e-9)));
}

}  // namespace palpa::session
