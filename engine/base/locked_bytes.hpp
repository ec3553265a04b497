// Locks that processes on one or several machines share through a file: each byte of it can be locked by one of them. A
// lock ends with its process, however that ends, so nothing has to be cleaned up after a crash.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/kept_from_forks.hpp"

namespace palpa {

/// A file of palpa's own in a folder of results; it is created if it is missing. Each of its bytes has a lock, and a
/// mark that stays.
class LockedBytes {
 public:
  /// Throws failure() naming the file if it cannot be created, or if its file system has no locks.
  explicit LockedBytes(const std::filesystem::path& file);
  /// Ends all of its locks.
  ~LockedBytes();
  LockedBytes(const LockedBytes&) = delete;
  LockedBytes& operator=(const LockedBytes&) = delete;

  /// False if another object has the lock, in this process or in another one. Never waits.
  bool try_lock(std::uint64_t byte);
  void unlock(std::uint64_t byte);

  /// Sets the mark of a byte. The caller has its lock.
  void mark(std::uint64_t byte);
  bool is_marked(std::uint64_t byte) const;

 private:
  bool change(std::uint64_t byte, short type);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::optional<KeptFromForks> kept_;
};

}  // namespace palpa
