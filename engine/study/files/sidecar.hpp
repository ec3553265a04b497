// The JSON file beside a log, which describes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::study {

/// The version of the logs that palpa reads and writes.
inline constexpr std::uint64_t log_version = 1;
/// BIDS' word for a value that does not exist.
inline constexpr std::string_view not_available = "n/a";

/// Beside PREFIX_events.tsv.
struct EventsSidecar {
  std::vector<std::string> shapes{};        ///< that were asked for, in their order; may be empty
  std::optional<std::uint32_t> checksum{};  ///< CRC-32 of the log when its session ended
  std::string plan_sha256{};                ///< of the plan's file; may be empty
  bool rehearsal = false;                   ///< no person was there
  std::uint32_t least_trials = 0;           ///< of the plan: with fewer, a participant is left out of comparisons
};
/// Throws bad_input for a file that is not such JSON, and for a log of another version.
EventsSidecar read_events_sidecar(const std::filesystem::path& file);

/// Beside PREFIX_recording-finger_physio.tsv.gz.
struct FingerSidecar {
  double rate_hz = 0;  ///< rows per second
  double start_s = 0;  ///< time of the first row, on the clock of the log's onsets
  std::size_t columns = 0;
  std::size_t depth_column = 0;
};
/// Throws bad_input for a file that is not such JSON, and for one without the column `depth`.
FingerSidecar read_finger_sidecar(const std::filesystem::path& file);

}  // namespace palpa::study
