// Writes to whatever a file name may stand for - a file, a pipe, a terminal, stdout - what is read while it grows,
// without waiting long for a reader. Files that are to be there whole or not at all are base/output_file.hpp's.
//
// A pipe that nobody reads is full after 64 KiB, and an ordinary write then waits for as long as it takes, Ctrl-C or
// not. Here bytes wait in memory instead, and flush() says how long it may take.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpa {

class StreamWriter {
 public:
  /// How long flush_patiently() waits for a reader that is too slow.
  static constexpr double patience_s = 1;
  /// And how long once that was not enough, until the reader has caught up.
  static constexpr double last_patience_s = 0.1;

  /// Creates or empties the file; "-" is stdout. As everywhere, opening a FIFO waits for its reader. At most `room`
  /// bytes will ever wait. Throws failure() naming the file.
  StreamWriter(const std::string& file, std::size_t room);
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  const std::string& name() const { return name_; }
  /// Whether it is a file on a disk: then what waits need not be written at once.
  bool on_disk() const { return on_disk_; }
  /// What has been added and is not written yet.
  std::string_view waiting() const { return {buffer_.data() + begin_, end_ - begin_}; }
  bool fits(std::size_t bytes) const { return bytes <= buffer_.size() - (end_ - begin_); }

  /// Adds a record to what waits; false, and nothing is added, where there is no room for it.
  bool add(std::string_view record);
  /// Writes what waits, but gives up after `seconds` (0: what can be written at once), or when `stop` becomes true.
  /// True when all is written. Throws failure(): a closed pipe, a full disk. Nothing can be written after that; a file
  /// on a disk then ends with its last whole record.
  bool flush(double seconds, const std::atomic<bool>* stop = nullptr);
  /// flush(patience_s), or with last_patience_s where the last such had to give up.
  bool flush_patiently();
  /// After a failure on a disk: `bytes` take the place of the last so many of the file, which needs no room that the
  /// file does not have already. The first `keep` bytes stay; false where the file is too short for that, or that does
  /// not work either.
  bool replace_end(std::string_view bytes, std::uint64_t keep);
  /// Closes the file, not stdout; some file systems tell of a full disk only here. What still waits is lost.
  void close();

  /// The failure() of a reader that is too slow; a file on a disk ends with its last whole record.
  [[noreturn]] void fail_stalled();

 private:
  void cut_to_whole_records() noexcept;
  std::uint64_t whole_records() const;

  std::string name_;
  int descriptor_ = -1;
  bool shared_ = false;  ///< stdout: whether its writes block is not for us to change
  bool on_disk_ = false;
  bool stalled_ = false;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t added_ = 0, written_ = 0;  ///< bytes, since the beginning
  std::vector<std::uint64_t> ends_;        ///< on a disk: where the records that were waiting after the last flush end
};

}  // namespace palpa
