// A tracker of hands, by the argument of `--source joints:`: frames come by UDP, or from a file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sensing/joints/tracked_hand.hpp"

namespace palpa::sensing {

class Tracker {
 public:
  virtual ~Tracker() = default;
  /// Waits until there is a frame, at most about `timeout_s`. `came`: whether there is one. Its hands in doubt are left
  /// out (hand_check.hpp). `number` counts from 0; gaps are frames that were left out for newer ones. Returns false at
  /// the end.
  virtual bool next(TrackedFrame& out, bool& came, std::uint64_t& number, double timeout_s) = 0;
};

/// Whether the argument names a port, so that the frames never end.
bool is_live_tracker(const std::string& argument);

/// `udp:PORT` and `udp:HOST:PORT` listen on a port of this computer: of its loopback, or of that address. Anything else
/// is a file with a line of JSON for each frame. `paced`: a file's frames come at their times, and late ones are left
/// out; otherwise, each comes when it is asked for. Throws bad_usage for an empty argument and for another form of
/// port, failure() for a port that cannot be opened, bad_input for a file without a frame, with a line that
/// read_frame() refuses, or with times that do not ascend.
std::unique_ptr<Tracker> open_tracker(const std::string& argument, bool paced);

/// The two kinds.
std::unique_ptr<Tracker> open_udp_tracker(const std::string& address);
std::unique_ptr<Tracker> open_file_tracker(const std::string& file, bool paced);

/// The limits of a file.
inline constexpr std::uint64_t most_tracker_bytes = 256U << 20, most_tracker_frames = 1'000'000;

}  // namespace palpa::sensing
