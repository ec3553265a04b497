// Films of fingers on the paper's objects in front of the paper's rig, played by the real `palpa run`, and the motion
// of its foci.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "sensing/synthetic.hpp"
#include "touch/types.hpp"

namespace palpa::test {

/// The motion of the finger of assets/finger.ply on an object, at 90 frames a second.
struct Film {
  std::string object;  ///< cube, semi-sphere, pyramid or prism: its top at y = 0 on the y axis
  std::string name;
  sensing::Motion motion;
  int frames = 0;
  std::string path;  ///< films with the same path are the same, whatever object they are played on
  sensing::Noise noise = sensing::Noise::d415;
  std::uint64_t seed = 5;
};

/// At rest near the object's middle, 2, 3 and 4 mm deep, `frames` each, with the finger away in between.
Film resting(const std::string& object, int frames);
/// Dips and sways like the finger of the synthetic source.
Film dipping(const std::string& object, int frames);
/// Slides by 0.25 mm per frame, noise-free: over the cube and its edges, across the prism's ridge or along it and over
/// its ends, over the pyramid's top, over the semi-sphere and down its sides. `half`: of long slides, only the end.
Film sliding(const std::string& object, bool along, bool half);
/// Back and forth at 100 mm/s, 20 ms each way, this many times.
Film fast(const std::string& object, int times);

inline constexpr double film_hz = 90;

/// Renders a film into a new folder, as a recording.
void record(const Film& film, const std::filesystem::path& folder);

/// One line of foci, which is one frame.
struct FociLine {
  double time_s = 0;
  struct Finger {
    std::uint32_t id = 0;
    std::vector<Vec3> foci;
    bool operator==(const Finger&) const = default;
  };
  std::vector<Finger> fingers;
};

/// The object that a film is played on, and the settings that keep its foci from jumping.
struct Play {
  std::string object;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
  std::uint32_t foci = 10;
};

/// Plays a film to sessions on the tests' device, one session per play. Returns for each play a line per frame. The
/// film is rendered once for all plays.
std::vector<std::vector<FociLine>> played(const Film& film, const std::vector<Play>& plays);

/// The lines that `palpa run --every-frame --link foci:udp` sends for a source, one for nearly every frame: two frames
/// that are ready within one slot have one line. `options` are added to the command line. The test fails if the program
/// fails.
std::vector<FociLine> sent_by_palpa(const std::string& source, const std::string& object,
                                    const std::vector<std::string>& options = {});

/// From frame to frame, movement of the focus that moves most: metres. `relative`: without the movement of the foci's
/// mean.
struct Movement {
  std::vector<double> relative, absolute;
  double share(double quantile) const { return at(relative, quantile); }
  static double at(std::vector<double> values, double quantile);
};
/// For consecutive frames; a touch's first `leave_out` frames do not count.
Movement movement_of(const std::vector<FociLine>& lines, int leave_out = 0);

/// The delay of the mean of the foci of `late` behind that of `early`, in seconds: least squares over all fingers.
double lag_of(const std::vector<FociLine>& early, const std::vector<FociLine>& late);

}  // namespace palpa::test
