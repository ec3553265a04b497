#include "base/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <utility>

namespace palpa {
namespace {

constexpr std::size_t block = 1 << 16;

/// Not taken by any other writer in this process; two processes meet at most by O_EXCL.
std::filesystem::path name_beside(const OutputPlace& place) {
  static std::atomic<std::uint64_t> count{0};
  return place.folder() / fmt::format(".palpa-{}-{}", ::getpid(), count++);
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& file) : place_(output_place(file)) {
  refuse_unwritable(place_);
  const bool whole = place_.kind == OutputPlace::Kind::absent || place_.kind == OutputPlace::Kind::file;
  if (whole && !place_.open_already && open_beside()) return;
  descriptor_ = file == "-" ? STDOUT_FILENO : ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw write_failure(place_.name, errno);
}

bool OutputFile::open_beside() {
  const bool replaces = place_.kind == OutputPlace::Kind::file;
  do {
    beside_ = name_beside(place_);
    descriptor_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) {
    beside_.clear();
    if (replaces && (errno == EACCES || errno == EPERM || errno == EROFS)) return false;
    throw write_failure(place_.name, errno);
  }
  if (!replaces) return true;
  const bool ours = ::fchown(descriptor_, place_.owner, place_.group) == 0 || place_.owner == ::geteuid();
  if (ours && ::fchmod(descriptor_, place_.mode) == 0) return true;
  ::close(std::exchange(descriptor_, -1));
  ::unlink(std::exchange(beside_, {}).c_str());
  return false;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0 && descriptor_ != STDOUT_FILENO) ::close(descriptor_);
  if (!beside_.empty()) ::unlink(beside_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > block) flush();
  if (bytes.size() > block) {
    put(bytes);
  } else {
    buffer_ += bytes;
  }
}

void OutputFile::flush() {
  put(buffer_);
  buffer_.clear();
}

void OutputFile::put(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (written < 0 && errno == EAGAIN) {
      // Whoever shares this pipe or terminal does not want to wait; here nothing else is to be done.
      pollfd room{descriptor_, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (written == 0 || errno != EINTR) {
      throw write_failure(place_.name, written == 0 ? 0 : errno);
    }
  }
}

void OutputFile::finish() {
  flush();
  const int closing = std::exchange(descriptor_, -1);
  // Some file systems tell of a full disk only here.
  if (closing != STDOUT_FILENO && ::close(closing) != 0) throw write_failure(place_.name, errno);
  if (beside_.empty()) return;
  if (::rename(beside_.c_str(), place_.path.c_str()) != 0) throw write_failure(place_.name, errno);
  beside_.clear();
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  OutputFile output(file);
  output.write(bytes);
  output.finish();
}

}  // namespace palpa
