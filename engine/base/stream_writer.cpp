#include "base/stream_writer.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cstdint>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/output_place.hpp"

namespace palpa {

StreamWriter::StreamWriter(const std::string& file, std::size_t room)
    : name_(file == "-" ? "stdout" : file), shared_(file == "-"), buffer_(room) {
  descriptor_ = shared_ ? STDOUT_FILENO : ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw write_failure(name_, errno);
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) throw write_failure(name_, errno);
  on_disk_ = S_ISREG(status.st_mode);
  if (!on_disk_ && !shared_) ::fcntl(descriptor_, F_SETFL, O_WRONLY | O_NONBLOCK);
}

StreamWriter::~StreamWriter() {
  if (descriptor_ >= 0 && !shared_) ::close(descriptor_);
}

bool StreamWriter::add(std::string_view record) {
  if (!fits(record.size())) return false;
  if (record.size() > buffer_.size() - end_) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  std::memcpy(buffer_.data() + end_, record.data(), record.size());
  end_ += record.size();
  added_ += record.size();
  if (on_disk_) ends_.push_back(added_);
  return true;
}

bool StreamWriter::flush(double seconds, const std::atomic<bool>* stop) {
  using Clock = std::chrono::steady_clock;
  constexpr std::int64_t slice_ms = 50;  // between looks at `stop`
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  for (bool in_time = true; begin_ != end_; in_time = Clock::now() < deadline && !(stop && *stop)) {
    if (!in_time) return false;
    const bool stopped = stop && *stop;
    const auto left = stopped ? 0 : std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd wanted{descriptor_, POLLOUT, 0};
    const int ready = ::poll(&wanted, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, slice_ms)));
    if (ready < 0 && errno != EINTR) throw write_failure(name_, errno);
    if (ready <= 0) continue;
    // A pipe that is ready has room for PIPE_BUF bytes; a longer write to one that may block could.
    const std::size_t most = shared_ && !on_disk_ ? std::size_t{PIPE_BUF} : end_ - begin_;
    const ssize_t written = ::write(descriptor_, buffer_.data() + begin_, std::min(most, end_ - begin_));
    if (written < 0 && errno != EINTR && errno != EAGAIN) {
      const int fault = errno;
      cut_to_whole_records();
      throw write_failure(name_, fault);
    }
    if (written > 0) {
      begin_ += static_cast<std::size_t>(written);
      written_ += static_cast<std::uint64_t>(written);
    }
  }
  begin_ = end_ = 0;
  ends_.assign(on_disk_ ? 1 : 0, written_);
  return true;
}

std::uint64_t StreamWriter::whole_records() const {
  const auto after = std::upper_bound(ends_.begin(), ends_.end(), written_);
  return after == ends_.begin() ? 0 : *(after - 1);
}

void StreamWriter::cut_to_whole_records() noexcept {
  if (!on_disk_) return;
  begin_ = end_ = 0;
  const std::uint64_t whole = whole_records();
  const off_t here = ::lseek(descriptor_, 0, SEEK_CUR);
  const off_t cut = here - static_cast<off_t>(written_ - whole);
  if (here < 0 || cut < 0 || cut == here) return;
  // Where even that fails, the record that was cut off is what the reader has to make do with.
  if (::ftruncate(descriptor_, cut) != 0 || ::lseek(descriptor_, cut, SEEK_SET) < 0) return;
  added_ = written_ = whole;
}

bool StreamWriter::replace_end(std::string_view bytes, std::uint64_t keep) {
  const off_t here = on_disk_ ? ::lseek(descriptor_, 0, SEEK_CUR) : -1;
  const off_t from = here - static_cast<off_t>(bytes.size());
  if (here < 0 || from < 0 || written_ < keep + bytes.size()) return false;
  return ::pwrite(descriptor_, bytes.data(), bytes.size(), from) == static_cast<ssize_t>(bytes.size());
}

bool StreamWriter::flush_patiently() {
  stalled_ = !flush(stalled_ ? last_patience_s : patience_s);
  return !stalled_;
}

void StreamWriter::close() {
  const int closing = std::exchange(descriptor_, -1);
  if (closing >= 0 && !shared_ && ::close(closing) != 0) throw write_failure(name_, errno);
}

void StreamWriter::fail_stalled() {
  cut_to_whole_records();
  throw failure(fmt::format("{}: cannot be written: its reader is too slow, or nobody reads it", name_));
}

}  // namespace palpa
