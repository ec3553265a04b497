// Recordings: a folder of 16-bit PNGs with cameras and times. The format is in docs/files.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/stream_writer.hpp"
#include "sensing/depth_source.hpp"

namespace palpa::sensing {

/// Writes a recording frame by frame. Whatever happens later, the frames written so far can be read back.
class RecordingWriter {
 public:
  /// Creates `folder` (its parent must exist; it may exist itself, empty) and writes `recording.toml` and the cameras'
  /// masks into it. Images keep all that a camera sees, what it ignores as well. Throws failure() when that does not
  /// work, bad_usage when the folder holds anything already or there is no camera.
  RecordingWriter(const std::filesystem::path& folder, const std::vector<Camera>& cameras);

  /// The images, then their line in `times.csv`. False, and nothing is written, where the set's time or number does not
  /// come after that of the one before, as when a camera was reset: a recording's times increase. Throws failure() on a
  /// full disk, bad_usage when the set does not fit the cameras.
  bool write(const FrameSet& set);
  std::uint64_t frames() const { return frames_; }
  /// Where there will be no frames: takes away what the constructor made. Does nothing once there is a frame.
  void discard();

 private:
  std::filesystem::path folder_;
  bool made_folder_ = false;
  std::vector<Camera> cameras_;
  std::optional<StreamWriter> times_;
  std::uint64_t frames_ = 0;
  double last_time_ = 0;
  std::uint64_t last_sequence_ = 0;
};

/// A recording's contents without its images.
struct Recording {
  struct Entry {
    std::vector<std::filesystem::path> files;  ///< one per camera
    std::vector<double> times_s;               ///< one per camera
    double time_s = 0;                         ///< the oldest of them
    std::uint64_t sequence = 0;
  };
  std::string file;  ///< of its TOML
  std::vector<Camera> cameras;
  std::vector<Entry> entries;
};

/// The first line of `times.csv`: "sequence,time_0_s,time_1_s" with two cameras.
std::string times_heading(std::size_t cameras);

/// Reads `recording.toml` of a folder, or the named TOML file. Throws bad_input naming file, line and fault: anything
/// that a rig's cameras may have wrong, no frame at all, a listed image that is missing, a file outside of the TOML's
/// folder (see ReferenceFolder), times that do not increase or
/// lie beyond 1e12 s, a `times.csv` with another heading than times_heading().
Recording load_recording(const std::filesystem::path& folder_or_toml);

/// The images of one entry. Throws bad_input naming the image: missing, no 16-bit grey PNG, not the camera's size.
void read_entry(const Recording& recording, std::size_t entry, FrameSet& out);

struct ReplayOptions {
  bool paced =
      true;  ///< frames come as far apart as they were recorded, and late ones are dropped; otherwise as fast as asked
  bool loop = false;  ///< begins again at the end: times and sequence numbers run on
};
std::unique_ptr<DepthSource> make_replay(Recording recording, ReplayOptions options = {});

}  // namespace palpa::sensing
