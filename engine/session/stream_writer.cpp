#include "session/stream_writer.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstring>
#include <system_error>
#include <utility>

#include "base/error.hpp"

namespace palpa::session {

StreamWriter::StreamWriter(const std::string& file, std::size_t room)
    : name_(file == "-" ? "stdout" : file), shared_(file == "-"), buffer_(room) {
  descriptor_ = shared_ ? STDOUT_FILENO : ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(errno);
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail(errno);
  on_disk_ = S_ISREG(status.st_mode);
  if (!on_disk_ && !shared_) ::fcntl(descriptor_, F_SETFL, O_WRONLY | O_NONBLOCK);
}

StreamWriter::~StreamWriter() {
  if (descriptor_ >= 0 && !shared_) ::close(descriptor_);
}

bool StreamWriter::add(std::string_view bytes) {
  if (!fits(bytes.size())) return false;
  if (bytes.size() > buffer_.size() - end_) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  std::memcpy(buffer_.data() + end_, bytes.data(), bytes.size());
  end_ += bytes.size();
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
    if (ready < 0 && errno != EINTR) fail(errno);
    if (ready <= 0) continue;
    // A pipe that is ready has room for PIPE_BUF bytes; a longer write to one that may block could.
    const std::size_t most = shared_ && !on_disk_ ? std::size_t{PIPE_BUF} : end_ - begin_;
    const ssize_t written = ::write(descriptor_, buffer_.data() + begin_, std::min(most, end_ - begin_));
    if (written < 0 && errno != EINTR && errno != EAGAIN) fail(errno);
    if (written > 0) begin_ += static_cast<std::size_t>(written);
  }
  begin_ = end_ = 0;
  return true;
}

bool StreamWriter::flush_patiently() {
  stalled_ = !flush(stalled_ ? last_patience_s : patience_s);
  return !stalled_;
}

void StreamWriter::close() {
  const int closing = std::exchange(descriptor_, -1);
  if (closing >= 0 && !shared_ && ::close(closing) != 0) fail(errno);
}

void StreamWriter::fail_stalled() const {
  throw failure(fmt::format("{}: cannot be written: its reader is too slow, or nobody reads it", name_));
}

void StreamWriter::fail(int code) const {
  throw failure(fmt::format("{}: cannot be written: {}", name_, std::generic_category().message(code)));
}

}  // namespace palpa::session
