// The recording of a finger during a session: PREFIX_recording-finger_physio.tsv.gz of BIDS, rows without a header at a
// constant rate. The JSON beside it names the columns; `depth` is metres below the top of the object.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/files/trial.hpp"

namespace palpa::study {

/// The time of a trial on the clock of the log.
struct TrialTime {
  double onset_s = 0;
  double duration_s = 0;
};

struct FingerFile {
  std::vector<DepthCourse> courses{};  ///< one per trial, possibly empty
  std::optional<std::string> fault{};  ///< a line about a recording that is cut
};

/// Reads the depths during these trials, whose onsets must ascend; a trial ends at the latest where the next begins.
/// Ten rows per second are read, and the others are skipped. Throws bad_input for anything but a table of numbers.
FingerFile read_finger(const std::filesystem::path& file, std::span<const TrialTime> trials);

}  // namespace palpa::study
