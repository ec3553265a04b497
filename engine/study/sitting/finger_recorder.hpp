// Writes where the finger was: PREFIX_recording-finger_physio.tsv.gz of BIDS and its sidecar, as read_finger() reads
// them. Rows come at a constant rate from the start of the program on, also between touches.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/files/output_file.hpp"
#include "base/math.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {

/// The lowest captured point over the object.
struct FingerSample {
  double depth_m = 0;  ///< below the top of the object
  Vec3 point{};        ///< world, metres
};

class FingerRecorder {
 public:
  static constexpr double rate_hz = 30;
  /// A row repeats the newest sample for no longer than this.
  static constexpr double longest_s = 0.25;

  /// Begins the files of that run, which must not be there yet. Throws failure().
  FingerRecorder(const ParticipantFolder& folder, std::uint32_t run);

  /// Times ascend. nullopt: nothing was captured over the object.
  void add(double time_s, const std::optional<FingerSample>& sample);
  /// Adds the rows up to that time. When it returns, they are on the disk. Throws failure(), for example for a full
  /// disk.
  void flush(double time_s);

 private:
  void rows_until(double time_s);

  OpenFile file_;
  std::string rows_;
  std::uint64_t next_row_ = 0;
  double sample_s_ = 0;
  std::optional<FingerSample> sample_;
};

}  // namespace palpa::study
