// Drives as a file, for replay and for tests that check the last drive sent.
//
// Little-endian: 8 bytes "palpadrv", u32 version (1), u32 transducers, f64 slot_s; then one record per drive: u64 slot
// and, per transducer, f32 amplitude and f32 phase. For 3984 transducers at 1.5 ms that is 21 MB/s.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "session/links/link.hpp"

namespace palpa::session {

/// Link "record:FILE"; "-" is stdout. Throws failure() if the file cannot be created or written (a full disk, a limit).
/// A file on a disk then holds only complete drives, as many as fit, and the last of them is silent. The file may be a
/// FIFO or a terminal. So that it cannot block the loop, a reader or a disk that keeps the link waiting for half a
/// second is an error, and so is a FIFO that nobody has opened for that long. `wait_unless` is for callers for which
/// nothing sounds meanwhile: the link then waits without a limit until that flag becomes true.
std::unique_ptr<Link> open_record_link(const std::string& file, const LinkSetting& setting,
                                       const std::atomic<bool>* wait_unless = nullptr);

struct RecordedDrive {
  std::uint64_t slot = 0;
  array::Drive drive;
};
struct DriveRecording {
  double slot_s = 0;
  std::uint32_t transducers = 0;
  std::vector<RecordedDrive> drives;
};
/// Throws bad_input naming the fault: not such a file, another version, or truncated within a record.
DriveRecording read_drive_recording(const std::filesystem::path& file);

}  // namespace palpa::session
