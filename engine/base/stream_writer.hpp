// Writes to whatever a file name may stand for - a file, a pipe, a terminal, stdout - what is read while it grows,
// and never lets its caller wait for it. Files that are to be there whole or not at all are base/output_file.hpp's.
//
// A pipe that nobody reads is full after 64 KiB, a terminal is stopped by Ctrl-S, a disk is behind a network that is
// gone: a write to any of them takes as long as it takes, Ctrl-C or not. So a thread of its own writes; what it has not
// written yet waits in memory, as much as there is room for, and flush() says how long it may take.
//
// A record of at most PIPE_BUF bytes (4096), such as a line, goes out in one write: on a pipe that others write to as
// well nothing comes between its halves, and where nobody reads it is there whole or not at all.
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
  /// How long flush_patiently() and add_patiently() wait for a reader, or a disk, that is too slow.
  static constexpr double patience_s = 0.5;
  /// And how long once that was not enough, until it has caught up.
  static constexpr double last_patience_s = 0.2;

  /// Creates or empties the file; "-" is stdout, and so is whatever stdout is open on. A FIFO's reader is waited for as
  /// `patience` says. At most `room` bytes will ever wait. Throws failure() naming the file, and what the register of
  /// files refuses.
  StreamWriter(const std::string& file, std::size_t room, ReaderPatience patience = std::nullopt);
  /// To what is open already, and stays open. `name` is for messages.
  StreamWriter(int descriptor, const std::string& name, std::size_t room);
  /// What still waits is lost. A thread that a write keeps in the kernel is left behind.
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  const std::string& name() const;
  /// Whether it is a file on a disk.
  bool on_disk() const;
  /// Before anything is added: makes room for more.
  void grow(std::size_t room);
  /// Should a file on a disk get no further, its last whole record is the last thing in it, and of that the last
  /// `bytes` are zeros; the first `keep` bytes of the file stay as they are. Where it is stdout, too.
  void end_in_zeros(std::size_t bytes, std::uint64_t keep);

  /// Adds a record to what waits; false, and nothing is added, where there is no room for it. Throws failure() where
  /// anything before it could not be written, a closed pipe, a full disk: then nothing can be written any more, and a
  /// file on a disk ends with its last whole record.
  bool add(std::string_view record);
  /// Waits for the room, up to patience_s, and for as much again as `spare`, which stays free.
  bool add_patiently(std::string_view record, std::size_t spare = 0);
  /// For whoever has nothing to silence: waits for the room as long as it takes, or until `stop` becomes true.
  bool add_waiting(std::string_view record, const std::atomic<bool>& stop);
  /// How many records have been added and are not written yet.
  std::uint64_t waiting() const;
  /// Waits until all is written, but gives up after `seconds`. True when all is written. Throws as add().
  bool flush(double seconds);
  /// flush(patience_s), or with last_patience_s where the last such had to give up.
  bool flush_patiently();
  /// As long as it takes, or until `stop` becomes true.
  bool flush_waiting(const std::atomic<bool>& stop);
  /// Closes the file, not stdout; some file systems tell of a full disk only here. What still waits is lost. Throws
  /// failure() where the disk does not answer, too.
  void close();

  /// The failure() of a reader or a disk that is too slow.
  [[noreturn]] void fail_stalled() const;

 private:
  struct Work;
  static void write_what_comes(const std::shared_ptr<Work>& work);
  void start();
  void begin(int descriptor, std::size_t room);
  bool flush(double seconds, const std::atomic<bool>* stop);

  std::shared_ptr<Work> work_;  ///< the thread's, too: it may outlive its writer
  bool stalled_ = false;
  bool closed_ = false;
};

}  // namespace palpa
