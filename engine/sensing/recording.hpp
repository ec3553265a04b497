// Recordings: a folder of 16-bit PNGs with cameras and times. The format is in docs/recording.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/output_file.hpp"
#include "sensing/depth_source.hpp"

namespace palpa::sensing {

/// For a folder that already has a recording.
enum class Existing { refused, replaced };

/// Writes a recording frame by frame. The frames written so far stay readable, whatever happens later.
class RecordingWriter {
 public:
  /// Creates `folder` (its parent must exist; the folder itself may exist if it is empty) and writes `recording.toml`
  /// and the cameras' masks into it. Images keep everything that a camera sees, including ignored pixels. If a
  /// recording in the folder is to be replaced, it stays as it is until the first frame comes. Throws failure() if the
  /// folder cannot be written, bad_usage if there is no camera, and if the folder is not empty or, when replacing, has
  /// anything else in it than a recording of palpa's.
  RecordingWriter(const std::filesystem::path& folder, const std::vector<Camera>& cameras,
                  Existing existing = Existing::refused);

  /// Writes the images, then their line in `times.csv`. Writes nothing and returns false if the set's time or number
  /// does not come after the previous one, for example after a camera was reset: a recording's times increase. Throws
  /// failure() on a full disk, bad_usage if the set does not fit the cameras.
  bool write(const FrameSet& set);
  std::uint64_t frames() const { return frames_; }
  /// For a recording without frames: removes what the constructor made. Does nothing once a frame was written.
  void discard();

 private:
  void begin();
  void refuse_while_written() const;

  std::filesystem::path folder_;
  bool made_folder_ = false;
  std::vector<Camera> cameras_;
  std::vector<std::filesystem::path> old_;  ///< files of the recording that is replaced
  std::optional<OpenFile> times_;           ///< once it has begun
  std::uint64_t frames_ = 0;
  double last_time_ = 0;
  std::uint64_t last_sequence_ = 0;
};

/// A recording's contents without its images.
struct Recording {
  struct Entry {
    std::vector<std::filesystem::path> files;  ///< one per camera
    std::vector<double> times_s;               ///< one per camera
    double time_s = 0;                         ///< the oldest of times_s
    std::uint64_t sequence = 0;
  };
  std::string file;  ///< the path of its TOML
  std::vector<Camera> cameras;
  std::vector<Entry> entries;
};

/// The first line of `times.csv`: "sequence,time_0_s,time_1_s" with two cameras.
std::string times_heading(std::size_t cameras);

/// Why these times of frames, ascending, are hardly seconds; empty if they may be. `rate_hz`: the rate that is stated
/// elsewhere, or 0. Times in another unit are more than 5 s apart, or not within a factor of 10 of the rate. Whole
/// numbers that mostly ascend by 1 are frame numbers, if the rate is unknown or at least 2 Hz.
std::string implausible_times(std::span<const double> times_s, double rate_hz);

/// Reads `recording.toml` of a folder, or the given TOML file. Throws bad_input naming file, line and fault: any fault
/// that a rig's cameras can have, no frames, a listed image that is missing, a file outside the TOML's folder (see
/// ReferenceFolder), times that do not increase or lie beyond 1e12 s, a `times.csv` whose heading differs from
/// times_heading(), a line of it that is broken. A last line without a line end that is broken is left out, with a
/// warning.
Recording load_recording(const std::filesystem::path& folder_or_toml);

/// The images of one entry. Throws bad_input naming the image: missing, not a 16-bit grey PNG, not the camera's size.
void read_entry(const Recording& recording, std::size_t entry, FrameSet& out);

struct PlaybackOptions {
  bool paced = true;  ///< at the recorded intervals, late frames are dropped; otherwise as fast as requested
  bool loop = false;  ///< starts again at the end; times and sequence numbers continue
};
std::unique_ptr<DepthSource> make_replay(Recording recording, PlaybackOptions options = {});

}  // namespace palpa::sensing
