#include "base/files/stream_writer.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "base/system/start_thread.hpp"

namespace palpa {
namespace {

/// How often waiting code checks whether it should continue.
constexpr double slice_s = 0.05;
using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

/// State shared by the writer and its thread.
struct StreamWriter::Work {
  OpenFile file;         ///< used only by the thread
  bool may_cut = false;  ///< on a disk, and only palpa decides where it ends

  std::mutex mutex;
  std::condition_variable to_do, done;
  std::deque<std::string> records;    ///< that are not completely written; the thread writes the first one
  std::size_t bytes = 0;              ///< in them
  std::size_t zeros = 0;              ///< see end_in_zeros()
  std::size_t last = 0;               ///< bytes of the last whole record since then
  bool closing = false;               ///< nothing more will be added
  std::atomic<bool> given_up{false};  ///< nothing more will be written
  bool ended = false;                 ///< the thread has closed the file
  std::optional<Error> fault;         ///< the thread has ended then

  bool put(std::string_view record);
  bool write_next();
  void write_zeros();
  void run();
};

/// Returns false if it gave up.
bool StreamWriter::Work::put(std::string_view record) {
  if (may_cut) {
    file.write(record);
    return true;
  }
  while (!record.empty() && !given_up) {
    pollfd wanted{file.descriptor(), POLLOUT, 0};
    const int ready = ::poll(&wanted, 1, static_cast<int>(slice_s * 1e3));
    // A pipe that is ready has room for PIPE_BUF bytes; a longer write could block.
    const std::size_t most = std::min(record.size(), std::size_t{PIPE_BUF});
    const ssize_t got = ready > 0 ? ::write(file.descriptor(), record.data(), most) : ready;
    if (got < 0 && errno != EINTR && errno != EAGAIN) throw write_failure(file.name(), errno);
    if (got > 0) record.remove_prefix(static_cast<std::size_t>(got));
  }
  return record.empty();
}

/// Waits for a record and writes it. Returns false after the last one.
bool StreamWriter::Work::write_next() {
  std::unique_lock lock(mutex);
  to_do.wait(lock, [&] { return !records.empty() || closing; });
  if (given_up || records.empty()) return false;
  const std::string& record = records.front();  // stays where it is while others are added
  lock.unlock();
  if (!put(record)) return false;
  lock.lock();
  last = record.size();
  bytes -= last;
  records.pop_front();
  done.notify_all();
  return true;
}

/// Overwrites the end of the last whole record, which needs no additional disk space. If even that fails, the reader
/// gets the file as it is.
void StreamWriter::Work::write_zeros() {
  const std::lock_guard lock(mutex);
  if (!may_cut || zeros == 0 || last < zeros) return;
  // On a file opened for appending, pwrite would append.
  const int descriptor = file.descriptor(), flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0 || ::fcntl(descriptor, F_SETFL, flags & ~O_APPEND) != 0) return;
  const off_t begin = ::lseek(descriptor, 0, SEEK_CUR) - static_cast<off_t>(zeros);
  static_cast<void>(!::pwrite(descriptor, std::string(zeros, '\0').data(), zeros, begin));
  ::fcntl(descriptor, F_SETFL, flags);
}

void StreamWriter::Work::run() {
  // A closed pipe or a file size limit must be reported as an error, and must not end the program by a signal.
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
  std::optional<Error> first_fault;
  try {
    while (write_next())
      continue;
    if (given_up) write_zeros();
    file.close();
  } catch (const Error& error) {
    first_fault = error;
    write_zeros();
    file = OpenFile();
  }
  const std::lock_guard lock(mutex);
  fault = first_fault;
  ended = true;
  done.notify_all();
}

StreamWriter::StreamWriter(OpenFile file, std::size_t room, bool others_write)
    : name_(file.name()), on_disk_(file.on_disk()), room_(room), process_(::getpid()), work_(std::make_shared<Work>()) {
  work_->file = std::move(file);
  work_->may_cut = on_disk_ && !others_write;
  try {
    start_thread("what is written", [work = work_] { work->run(); }).detach();
  } catch (const Error& error) {
    throw failure(fmt::format("{}: {}", name_, error.what()));
  }
}

/// Then another thread may have had the mutex when fork() came.
bool StreamWriter::is_of_parent() const {
  return ::getpid() != process_;
}

StreamWriter::~StreamWriter() {
  try {
    close();
  } catch (const Error&) {  // there is nobody to report it to
  }
}

void StreamWriter::end_in_zeros(std::size_t bytes) {
  if (is_of_parent()) return;
  const std::lock_guard lock(work_->mutex);
  work_->zeros = bytes;
  work_->last = 0;
}

bool StreamWriter::add(std::string_view record, const Patience& patience, std::size_t spare) {
  if (!wait_for(record.size() + spare, patience)) return false;
  const std::lock_guard lock(work_->mutex);
  work_->records.emplace_back(record);
  work_->bytes += record.size();
  work_->to_do.notify_one();
  return true;
}

std::uint64_t StreamWriter::waiting() const {
  if (is_of_parent()) return 0;
  const std::lock_guard lock(work_->mutex);
  return work_->records.size();
}

bool StreamWriter::wait_for(std::size_t room, const Patience& patience) {
  if (is_of_parent()) return false;
  constexpr double forever_s = 1e6;
  const double limit_s = stalled_ ? last_patience_s : forever_s;
  const double seconds = patience.seconds ? std::min(*patience.seconds, limit_s) : forever_s;
  const Clock::time_point end = after(seconds);
  Work& w = *work_;
  std::unique_lock lock(w.mutex);
  const auto over = [&] { return w.fault || room_ - w.bytes >= room; };
  while (!over() && Clock::now() < end && !(patience.stop && *patience.stop))
    w.done.wait_until(lock, std::min(end, after(slice_s)), over);
  if (w.fault) throw Error(*w.fault);
  if (seconds > 0) stalled_ = !over();
  return over();
}

void StreamWriter::close() {
  if (std::exchange(closed_, true) || is_of_parent()) return;
  Work& w = *work_;
  std::unique_lock lock(w.mutex);
  w.closing = true;
  w.given_up = !w.records.empty();
  w.to_do.notify_one();
  const bool answers = w.done.wait_until(lock, after(patience()), [&] { return w.ended; });
  if (w.fault) throw Error(*w.fault);
  if (!answers) fail_stalled();
}

void StreamWriter::fail_stalled() const {
  throw failure(fmt::format(
      "{}: cannot be written: {}", name_,
      on_disk_ ? "the disk is too slow, or does not answer" : "its reader is too slow, or nobody reads it"));
}

}  // namespace palpa
