#include "base/stream_writer.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/output_place.hpp"
#include "base/start_thread.hpp"

namespace palpa {
namespace {

/// How often waiting code checks whether it should continue.
constexpr auto slice = std::chrono::milliseconds(50);

/// The maximum size of one write. Between two writes, the thread notices that the writer has given up.
constexpr std::size_t piece = 1 << 18;

/// Longer than any wait.
constexpr double forever_s = 1e6;

std::chrono::steady_clock::time_point after(double seconds) {
  using Clock = std::chrono::steady_clock;
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

/// State shared by the writer and its thread.
struct StreamWriter::Work {
  // Used by both, and constant once the thread runs.
  std::string name;
  int descriptor = -1;
  bool shared = false;   ///< opened by others: palpa must neither change its blocking mode nor close it
  bool on_disk = false;  ///< a regular file
  bool may_cut = false;  ///< only palpa decides where it ends

  std::mutex mutex;
  std::condition_variable to_do, done;
  std::size_t room = 0;
  std::string waiting;                              ///< data that the thread has not taken yet
  std::deque<std::uint64_t> ends;                   ///< ends of the records that are not completely written
  std::uint64_t added = 0, written = 0, whole = 0;  ///< bytes since the start; whole: up to the last record's end
  std::size_t zeros = 0;                            ///< see end_in_zeros()
  std::uint64_t keep = 0;
  bool closing = false;      ///< nothing more will be added
  bool given_up = false;     ///< nothing more will be written
  bool ended = false;        ///< the thread has closed the file
  std::optional<int> fault;  ///< errno; the thread has ended then

  std::string taken;  ///< used only by the thread: the data that it is writing

  bool is_given_up();
  std::size_t next_piece(std::size_t left);
  void written_more(std::size_t bytes);
  std::optional<int> write_taken();
  void end_at_whole_record() const;
  void write_zeros(off_t end) const;
  void end(std::optional<int> fault);
};

bool StreamWriter::Work::is_given_up() {
  const std::lock_guard lock(mutex);
  return given_up;
}

void StreamWriter::Work::written_more(std::size_t bytes) {
  const std::lock_guard lock(mutex);
  written += bytes;
  while (!ends.empty() && ends.front() <= written) {
    whole = ends.front();
    ends.pop_front();
  }
  done.notify_all();
}

/// The number of the `left` bytes to put into one write: as many whole records as fit, or a part of a longer one.
std::size_t StreamWriter::Work::next_piece(std::size_t left) {
  const std::lock_guard lock(mutex);
  // A pipe that is ready has room for PIPE_BUF bytes; a longer write to a blocking pipe could block.
  const std::size_t most = std::min(left, on_disk ? piece : std::size_t{PIPE_BUF});
  const auto beyond = std::upper_bound(ends.begin(), ends.end(), written + most);
  if (beyond != ends.begin()) return *std::prev(beyond) - written;
  return std::min({left, shared ? most : piece, static_cast<std::size_t>(ends.front() - written)});
}

/// Returns the error, if any.
std::optional<int> StreamWriter::Work::write_taken() {
  std::string_view rest = taken;
  while (!rest.empty() && !is_given_up()) {
    pollfd wanted{descriptor, POLLOUT, 0};
    const int ready = ::poll(&wanted, 1, static_cast<int>(slice.count()));
    if (ready < 0 && errno != EINTR) return errno;
    if (ready <= 0) continue;
    const ssize_t got = ::write(descriptor, rest.data(), next_piece(rest.size()));
    if (got < 0 && errno != EINTR && errno != EAGAIN) return errno;
    if (got <= 0) continue;
    rest.remove_prefix(static_cast<std::size_t>(got));
    written_more(static_cast<std::size_t>(got));
  }
  taken.clear();
  return std::nullopt;
}

/// Removes an incomplete record, and makes the last whole record end in zeros, which needs no additional disk space. If
/// even that fails, the reader gets the file as it is.
void StreamWriter::Work::end_at_whole_record() const {
  if (!may_cut) return;
  const off_t here = ::lseek(descriptor, 0, SEEK_CUR);
  const off_t cut = here - static_cast<off_t>(written - whole);
  if (here < 0 || cut < 0) return;
  if (cut != here && (::ftruncate(descriptor, cut) != 0 || ::lseek(descriptor, cut, SEEK_SET) < 0)) return;
  if (zeros == 0 || whole < keep + zeros) return;
  // On a file opened for appending, pwrite would append.
  const int flags = ::fcntl(descriptor, F_GETFL);
  const bool appends = flags >= 0 && (flags & O_APPEND) != 0;
  if (appends && ::fcntl(descriptor, F_SETFL, flags & ~O_APPEND) != 0) return;
  write_zeros(cut);
  if (appends) ::fcntl(descriptor, F_SETFL, flags);
}

/// Overwrites the last `zeros` bytes before `end`.
void StreamWriter::Work::write_zeros(off_t end) const {
  constexpr std::array<char, 4096> nothing{};
  for (std::size_t left = zeros; left > 0;) {
    const std::size_t size = std::min(left, nothing.size());
    if (::pwrite(descriptor, nothing.data(), size, end - static_cast<off_t>(left)) != static_cast<ssize_t>(size))
      return;
    left -= size;
  }
}

void StreamWriter::Work::end(std::optional<int> first_fault) {
  if (!shared && ::close(descriptor) != 0 && !first_fault) first_fault = errno;
  const std::lock_guard lock(mutex);
  fault = first_fault;
  ended = true;
  done.notify_all();
}

void StreamWriter::write_what_comes(const std::shared_ptr<Work>& work) {
  // A closed pipe or a file size limit must be reported as an error, and must not end the program by a signal.
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
  Work& w = *work;
  std::optional<int> fault;
  for (bool whole = true; whole;) {
    {
      std::unique_lock lock(w.mutex);
      w.to_do.wait(lock, [&] { return !w.waiting.empty() || w.closing; });
      if (w.given_up || w.waiting.empty()) break;
      std::swap(w.waiting, w.taken);
    }
    fault = w.write_taken();
    whole = !fault && !w.is_given_up();
  }
  // Before the failure becomes visible.
  if (fault || w.is_given_up()) w.end_at_whole_record();
  w.end(fault);
}

StreamWriter::StreamWriter(const std::string& file, std::size_t room, ReaderPatience patience)
    : work_(std::make_shared<Work>()) {
  const OutputPlace place = output_place(file);
  work_->name = place.name;
  work_->shared = place.is_stdout;
  begin(open_output(file, place, patience), room);
  work_->may_cut = work_->on_disk;
  start();
}

StreamWriter::StreamWriter(int descriptor, const std::string& name, std::size_t room)
    : work_(std::make_shared<Work>()) {
  work_->name = name;
  work_->shared = true;
  begin(descriptor, room);
  start();
}

void StreamWriter::begin(int descriptor, std::size_t room) {
  if (descriptor < 0) throw write_failure(work_->name, errno);
  work_->descriptor = descriptor;
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) {
    const int fault = errno;
    if (!work_->shared) ::close(descriptor);
    throw write_failure(work_->name, fault);
  }
  work_->on_disk = S_ISREG(status.st_mode);
  if (!work_->on_disk && !work_->shared) ::fcntl(descriptor, F_SETFL, O_WRONLY | O_NONBLOCK);
  grow(room);
}

void StreamWriter::start() {
  try {
    start_thread("what is written", [work = work_] { write_what_comes(work); }).detach();
  } catch (const Error& error) {
    if (!work_->shared) ::close(work_->descriptor);
    throw failure(fmt::format("{}: {}", work_->name, error.what()));
  }
}

StreamWriter::~StreamWriter() {
  try {
    if (!closed_) close();
  } catch (const Error&) {  // there is nobody to report it to
  }
}

const std::string& StreamWriter::name() const {
  return work_->name;
}

bool StreamWriter::on_disk() const {
  return work_->on_disk;
}

double StreamWriter::patience() const {
  return work_->on_disk ? disk_patience_s : patience_s;
}

void StreamWriter::grow(std::size_t room) {
  const std::lock_guard lock(work_->mutex);
  work_->room = room;
  work_->waiting.reserve(room);
  work_->taken.reserve(room);
}

void StreamWriter::end_in_zeros(std::size_t bytes, std::uint64_t keep) {
  const std::lock_guard lock(work_->mutex);
  work_->zeros = bytes;
  work_->keep = keep;
}

bool StreamWriter::add(std::string_view record) {
  Work& w = *work_;
  const std::lock_guard lock(w.mutex);
  if (w.fault) throw write_failure(w.name, *w.fault);
  if (record.size() > w.room - (w.added - w.written)) return false;
  w.waiting += record;
  w.added += record.size();
  w.ends.push_back(w.added);
  w.to_do.notify_one();
  return true;
}

bool StreamWriter::add_patiently(std::string_view record, std::size_t spare) {
  Work& w = *work_;
  {
    std::unique_lock lock(w.mutex);
    const auto fits = [&] { return w.fault || record.size() + spare <= w.room - (w.added - w.written); };
    stalled_ = !w.done.wait_until(lock, after(stalled_ ? last_patience_s : patience_s), fits);
  }
  return !stalled_ && add(record);
}

bool StreamWriter::add_waiting(std::string_view record, const std::atomic<bool>& stop) {
  return add(record) || (flush_waiting(stop) && add(record));
}

std::uint64_t StreamWriter::waiting() const {
  const std::lock_guard lock(work_->mutex);
  return work_->ends.size();
}

bool StreamWriter::flush(double seconds, const std::atomic<bool>* stop) {
  Work& w = *work_;
  const auto deadline = after(seconds);
  std::unique_lock lock(w.mutex);
  const auto over = [&] { return w.fault || w.written == w.added; };
  while (!over() && std::chrono::steady_clock::now() < deadline && !(stop && *stop)) {
    w.done.wait_until(lock, std::min(deadline, std::chrono::steady_clock::now() + slice), over);
  }
  if (w.fault) throw write_failure(w.name, *w.fault);
  stalled_ = w.written != w.added;
  return !stalled_;
}

bool StreamWriter::flush(double seconds) {
  return flush(seconds, nullptr);
}

bool StreamWriter::flush_waiting(const std::atomic<bool>& stop) {
  return flush(forever_s, &stop);
}

bool StreamWriter::flush_patiently() {
  return flush(stalled_ ? last_patience_s : patience());
}

void StreamWriter::close() {
  if (std::exchange(closed_, true)) return;
  Work& w = *work_;
  std::unique_lock lock(w.mutex);
  w.closing = true;
  w.given_up = w.written != w.added;
  w.to_do.notify_one();
  const bool answers = w.done.wait_until(lock, after(stalled_ ? last_patience_s : patience()), [&] { return w.ended; });
  if (w.fault) throw write_failure(w.name, *w.fault);
  lock.unlock();
  if (!answers) fail_stalled();
}

void StreamWriter::fail_stalled() const {
  throw failure(fmt::format(
      "{}: cannot be written: {}", work_->name,
      work_->on_disk ? "the disk is too slow, or does not answer" : "its reader is too slow, or nobody reads it"));
}

}  // namespace palpa
