// Drives as a file.
//
// Little-endian: 8 bytes "palpadrv", u32 version (1), u32 transducers, f64 slot_s; then one record per drive: u64 slot
// and, per transducer, f32 amplitude and f32 phase. For 3984 transducers at 1.5 ms that is 21 MB/s.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "session/links/link.hpp"

namespace palpa::session {

/// Link "record:FILE"; "-" is stdout. Throws failure() if the file cannot be created or written (a full disk, a limit).
/// A file on a disk then holds only complete drives, as many as fit, and the last of them is silent. The file may be a
/// FIFO or a terminal. So that it cannot block the loop, a reader or a disk that keeps the link waiting for half a
/// second is an error, and so is a FIFO that nobody has opened for that long. `wait_unless` is for callers for which
/// nothing sounds meanwhile: the link then waits without a limit until that flag becomes true.
std::unique_ptr<Link> open_record_link(const std::string& file, const LinkSetting& setting,
                                       const std::atomic<bool>* wait_unless = nullptr);

}  // namespace palpa::session
