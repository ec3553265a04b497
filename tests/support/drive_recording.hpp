// Drives that `--link record:FILE` wrote: engine/session/links/record_link.hpp has the format.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "array/transducer_drive.hpp"
#include "support/files.hpp"

namespace palpa::test {

struct RecordedDrive {
  std::uint64_t slot = 0;
  array::Drive drive;
};
struct DriveRecording {
  double slot_s = 0;
  std::uint32_t transducers = 0;
  std::vector<RecordedDrive> drives;
};

/// Throws std::runtime_error for another file, and for one that ends within a record.
inline DriveRecording read_drive_recording(const std::filesystem::path& file) {
  const std::string bytes = read_text(file), magic = "palpadrv";
  if (!bytes.starts_with(magic)) throw std::runtime_error(file.string() + " has no drives");
  std::size_t at = magic.size();
  const auto take = [&](void* into, std::size_t size) {
    if (bytes.size() - at < size) throw std::runtime_error(file.string() + " is cut off");
    std::memcpy(into, bytes.data() + at, size);
    at += size;
  };
  std::uint32_t version = 0;
  DriveRecording recording;
  take(&version, sizeof(version));
  if (version != 1) throw std::runtime_error(file.string() + " has another version");
  take(&recording.transducers, sizeof(recording.transducers));
  take(&recording.slot_s, sizeof(recording.slot_s));
  while (at < bytes.size()) {
    RecordedDrive& record = recording.drives.emplace_back();
    record.drive.resize(recording.transducers);
    take(&record.slot, sizeof(record.slot));
    take(record.drive.data(), record.drive.size() * sizeof(array::TransducerDrive));
  }
  return recording;
}

}  // namespace palpa::test
