// Writes output that is read while it grows to any kind of file (a regular file, a pipe, a terminal, stdout) and never
// blocks its caller for longer than that allows. A write blocks, regardless of Ctrl-C, if nobody reads a pipe, a
// terminal is stopped by Ctrl-S, or a disk is behind a network that is gone. Therefore a separate thread does the
// writing, and what is unwritten waits in memory of limited size.
//
// A record of at most PIPE_BUF bytes (4096), such as a line, goes out in one write. On a pipe with several writers
// nothing is mixed into it, and without a reader it is written completely or not at all.
//
// A process that fork() makes has no such thread. There, a writer does nothing: what waits is its parent's to write.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/files/output_file.hpp"

namespace palpa {

/// For one thread at a time.
class StreamWriter {
 public:
  static constexpr double patience_s = 0.5;      ///< for a slow reader
  static constexpr double disk_patience_s = 10;  ///< for a disk: other programs can keep it busy for seconds
  /// If a wait with a limit was not enough, no other lasts longer than this until the reader or disk has caught up.
  static constexpr double last_patience_s = 0.2;

  /// At most `room` bytes will ever wait. If others write to the file, too, its end is not cut to a whole record.
  StreamWriter(OpenFile file, std::size_t room, bool others_write = false);
  /// Discards what still waits. A thread that is blocked in a write is abandoned.
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  const std::string& name() const { return name_; }
  bool on_disk() const { return on_disk_; }
  /// For the records from now on: if a file on a disk (also as stdout) cannot grow further, it will end with its last
  /// whole record, and the last `bytes` of that record will be zeros.
  void end_in_zeros(std::size_t bytes);

  /// Queues a record, once there is room for it and for `spare` bytes that stay free. Returns false, without queueing
  /// it, if there is not. Throws failure() if anything before it could not be written (a closed pipe, a full disk).
  /// After that nothing more can be written, and a file on a disk ends with its last whole record.
  bool add(std::string_view record, const Patience& patience = {.seconds = 0}, std::size_t spare = 0);
  /// The number of records that were added but not written yet.
  std::uint64_t waiting() const;
  /// Waits until everything is written. Returns true if it is. Throws as add().
  bool flush(const Patience& patience) { return wait_for(room_, patience); }
  /// Waits patience_s, or disk_patience_s for a disk.
  bool flush() { return flush({.seconds = patience()}); }
  /// Closes the file. Discards what still waits. Waits as flush() does, and throws failure(), also if a disk does not
  /// answer in that time.
  void close();

  /// Throws the failure() for a reader or disk that is too slow.
  [[noreturn]] void fail_stalled() const;

 private:
  struct Work;
  bool is_of_parent() const;
  double patience() const { return stalled_ ? last_patience_s : on_disk_ ? disk_patience_s : patience_s; }
  bool wait_for(std::size_t room, const Patience& patience);

  std::string name_;
  bool on_disk_;
  std::size_t room_;
  pid_t process_;               ///< that has the thread
  std::shared_ptr<Work> work_;  ///< shared with the thread, which may outlive the writer
  bool stalled_ = false;
  bool closed_ = false;
};

}  // namespace palpa
