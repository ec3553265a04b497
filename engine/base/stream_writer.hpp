// Writes output that is read while it grows to any kind of file (a regular file, a pipe, a terminal, stdout) and never
// blocks its caller. Files that must be complete or absent belong to base/output_file.hpp.
//
// A pipe that nobody reads is full after 64 KiB, a terminal is stopped by Ctrl-S, or a disk is behind a network that is
// gone. A write to any of them blocks, regardless of Ctrl-C. A separate thread therefore does the writing. Unwritten
// data waits in memory of limited size, and the argument of flush() limits the wait.
//
// A record of at most PIPE_BUF bytes (4096), such as a line, goes out in one write. On a pipe with several writers
// nothing is mixed into it, and without a reader it is written completely or not at all.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/open_output.hpp"

namespace palpa {

class StreamWriter {
 public:
  /// How long flush_patiently() and close() wait for a slow reader, and add_patiently() for a slow reader or disk.
  static constexpr double patience_s = 0.5;
  /// How long flush_patiently() and close() wait for a disk. Other programs can keep a disk busy for seconds.
  static constexpr double disk_patience_s = 10;
  /// How long they wait after that was not enough, until the reader or disk has caught up.
  static constexpr double last_patience_s = 0.2;

  /// Creates or empties the file; "-" is stdout, and so is any name of the file that stdout is open on. Waits for a
  /// FIFO's reader as long as `patience` allows. At most `room` bytes will ever wait. Throws failure() naming the file,
  /// and the errors of the register of files.
  StreamWriter(const std::string& file, std::size_t room, ReaderPatience patience = std::nullopt);
  /// Writes to a descriptor that is already open and stays open. `name` is for messages.
  StreamWriter(int descriptor, const std::string& name, std::size_t room);
  /// Discards what still waits. A thread that is blocked in a write is abandoned.
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  const std::string& name() const;
  /// Whether the output is a file on a disk.
  bool on_disk() const;
  /// disk_patience_s for a file on a disk, patience_s for everything else.
  double patience() const;
  /// Makes room for more waiting data. Call it before anything is added.
  void grow(std::size_t room);
  /// If a file on a disk (also as stdout) cannot grow further, it will end with its last whole record, the last `bytes`
  /// of that record will be zeros, and the first `keep` bytes of the file stay unchanged.
  void end_in_zeros(std::size_t bytes, std::uint64_t keep);

  /// Queues a record. Returns false, without queueing it, if there is no room. Throws failure() if anything before it
  /// could not be written (a closed pipe, a full disk). After that nothing more can be written, and a file on a disk
  /// ends with its last whole record.
  bool add(std::string_view record);
  /// Waits up to patience_s for room for the record plus `spare` bytes that stay free.
  bool add_patiently(std::string_view record, std::size_t spare = 0);
  /// For callers that have no array to silence: waits for room without limit, or until `stop` becomes true.
  bool add_waiting(std::string_view record, const std::atomic<bool>& stop);
  /// The number of records that were added but not written yet.
  std::uint64_t waiting() const;
  /// Waits until everything is written, at most `seconds`. Returns true if everything is written. Throws as add().
  bool flush(double seconds);
  /// flush(patience()), or flush(last_patience_s) if the last such call timed out.
  bool flush_patiently();
  /// Waits without limit, or until `stop` becomes true.
  bool flush_waiting(const std::atomic<bool>& stop);
  /// Closes the file, but not stdout. Some file systems report a full disk only here. Discards what still waits. Throws
  /// failure(), also if the disk does not answer.
  void close();

  /// Throws the failure() for a reader or disk that is too slow.
  [[noreturn]] void fail_stalled() const;

 private:
  struct Work;
  static void write_what_comes(const std::shared_ptr<Work>& work);
  void start();
  void begin(int descriptor, std::size_t room);
  bool flush(double seconds, const std::atomic<bool>* stop);

  std::shared_ptr<Work> work_;  ///< shared with the thread, which may outlive the writer
  bool stalled_ = false;
  bool closed_ = false;
};

}  // namespace palpa
