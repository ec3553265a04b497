// Fingertips that press into the paper's objects in front of rigs of one to three depth cameras.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "sensing/depth_source.hpp"
#include "touch/types.hpp"

namespace palpa::touch::test {

/// `count` D415 in a ring around the origin, `distance_m` away, looking at it from `elevation_deg` above the horizon;
/// the first at `azimuth_deg` from +x towards +z.
std::vector<sensing::Camera> ring_of_cameras(int count, double elevation_deg, double azimuth_deg,
                                             double distance_m = 0.35);
/// The first `count` cameras of the paper's rig, which look up.
std::vector<sensing::Camera> paper_cameras(int count);

std::vector<geometry::Solid> object(const std::string& name);

/// A finger that leans by `tilt_deg` from the vertical towards `azimuth_deg`. Its lowest place is `press_m` below (x,
/// y, z). If it comes from below, its highest place is as far above.
struct Press {
  double press_m = 3e-3, tilt_deg = 0, azimuth_deg = 0, x = 0, y = 0, z = 0;
  bool from_below = false;
  double scale = 1;  ///< of the finger, 18 mm thick
};

/// The images of these fingers by the cameras, with the D415's faults.
std::vector<sensing::DepthFrame> images_of(const std::vector<sensing::Camera>& cameras,
                                           const std::vector<Press>& presses, std::uint64_t seed);

/// For each finger, the number of presses whose contacts it holds. A press with less than a tenth of the finger's
/// contacts does not count.
std::vector<int> presses_in_fingers(const Touch& touch, const std::vector<Press>& presses);

/// One fingertip, or two side by side, 0.5 to 4 mm apart, pressed 1 to 6 mm deep into one of the paper's objects,
/// upright or leaning up to 65 degrees at any azimuth, in front of a rig of cameras.
struct Trial {
  std::vector<sensing::Camera> cameras;
  std::vector<Press> presses;
  std::string object;
  std::vector<sensing::DepthFrame> images;
};
/// As the elevation, it means: the first cameras of the paper's rig instead of a ring at any azimuth.
inline constexpr double paper_rig = -99;
inline constexpr std::array<double, 5> trial_elevations{paper_rig, -30, 0, 20, 35};
inline constexpr std::array trial_objects{"cube", "semi-sphere", "prism"};
Trial random_trial(std::mt19937& random, int cameras, double elevation_deg, const std::string& object,
                   std::size_t fingers);

}  // namespace palpa::touch::test
