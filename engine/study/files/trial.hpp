// The trials of a study, as they are analysed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpa::study {

/// One answered trial. Numbers of method, shape and answer are places in the lists of Study.
struct Trial {
  std::uint32_t method = 0;
  std::uint32_t shape = 0;
  std::uint32_t answer = 0;
  std::optional<double> response_s{};  ///< from the end of the touch to the answer
  bool correct() const { return shape == answer; }
};

/// The depth of a finger below the top of an object, summed over trials, in bins from the start of a trial.
struct DepthCourse {
  static constexpr double bin_s = 0.25;
  static constexpr std::size_t most_bins = 240;
  std::vector<double> sum_m{};
  std::vector<std::uint32_t> samples{};  ///< per bin; bins after the last sample are left out

  void add(double time_s, double depth_m);
  bool empty() const { return samples.empty(); }
};

struct Participant {
  std::uint32_t number = 0;
  std::string place{};                 ///< its folder, for messages
  std::vector<Trial> trials{};         ///< in the order in which they took place
  std::vector<std::uint32_t> voids{};  ///< void trials, by method
  /// The same by method, then shape: trials lack their stimulus for a reason, not by chance.
  std::vector<std::uint32_t> void_shapes{};
  std::uint32_t asked = 0, unfelt = 0;  ///< familiarisations after which it was asked, and those without a sensation
  std::vector<DepthCourse> depths{};    ///< by method, then shape; empty without a recording of the finger
};

struct Study {
  std::vector<std::string> methods{};  ///< single-focus first, if it is there, then by name
  std::vector<std::string> shapes{};
  std::vector<Participant> participants{};  ///< by number
  std::uint32_t least_trials = 0;           ///< of the plan: with fewer, a participant is left out of comparisons
  std::vector<std::string> left_out{};      ///< one line for each file, row or participant that is not analysed
};

inline constexpr std::size_t most_methods = 16;
inline constexpr std::size_t most_shapes = 64;
inline constexpr std::size_t most_participants = 1000;
/// The longest name of a shape or method.
inline constexpr std::size_t most_name = 64;

}  // namespace palpa::study
