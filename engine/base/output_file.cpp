#include "base/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <utility>

#include "base/file_register.hpp"
#include "base/open_output.hpp"

namespace palpa {
namespace {

constexpr std::size_t block = 1 << 16;

/// A name that no other writer in this process uses; between two processes, O_EXCL prevents collisions.
std::filesystem::path new_name(const OutputPlace& place) {
  static std::atomic<std::uint64_t> count{0};
  return place.folder() / fmt::format(".palpa-{}-{}", ::getpid(), count++);
}

/// The path for linking a descriptor without a name.
std::string link_of(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& file) : place_(output_place(file)) {
  refuse_unwritable(place_);
  file_register::writes(place_);
  const bool whole = place_.kind == OutputPlace::Kind::absent || place_.kind == OutputPlace::Kind::file;
  if (whole && !place_.open_already && open_beside()) return;
  descriptor_ = open_output(file, place_);
}

/// Creates the file without a name if the file system supports that.
bool OutputFile::create_beside() {
  descriptor_ = ::open(place_.folder().c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (descriptor_ >= 0 && ::access(link_of(descriptor_).c_str(), F_OK) == 0) return true;
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  do {
    beside_ = new_name(place_);
    descriptor_ = ::open(beside_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) beside_.clear();
  return descriptor_ >= 0;
}

bool OutputFile::open_beside() {
  const bool replaces = place_.kind == OutputPlace::Kind::file;
  if (!create_beside()) {
    if (replaces && (errno == EACCES || errno == EPERM || errno == EROFS)) return false;
    throw write_failure(place_.name, errno);
  }
  in_place_ = false;
  if (!replaces) return true;
  if (::fchown(descriptor_, place_.owner, place_.group) == 0 && ::fchmod(descriptor_, place_.mode) == 0) return true;
  ::close(std::exchange(descriptor_, -1));
  if (!beside_.empty()) ::unlink(std::exchange(beside_, {}).c_str());
  in_place_ = true;
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

void OutputFile::put(int descriptor, std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (written < 0 && errno == EAGAIN) {
      // Another process made this pipe or terminal non-blocking; there is nothing else to do here but wait.
      pollfd room{descriptor, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (written == 0 || errno != EINTR) {
      throw write_failure(place_.name, written == 0 ? 0 : errno);
    }
  }
}

void OutputFile::name_beside() {
  const std::string link = link_of(descriptor_);
  std::filesystem::path name;
  int fault = 0;
  do {
    name = new_name(place_);
    fault = ::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
  } while (fault == EEXIST);
  if (fault != 0) throw write_failure(place_.name, fault);
  beside_ = name;
}

void OutputFile::copy_into_place() {
  const int into = reopen_output(place_);
  buffer_.resize(block);
  try {
    for (off_t at = 0;;) {
      const ssize_t got = ::pread(descriptor_, buffer_.data(), buffer_.size(), at);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw write_failure(place_.name, errno);
      if (got == 0) break;
      put(into, std::string_view(buffer_.data(), static_cast<std::size_t>(got)));
      at += got;
    }
  } catch (...) {
    ::close(into);
    throw;
  }
  if (::close(into) != 0) throw write_failure(place_.name, errno);
}

void OutputFile::put_in_place() {
  if (place_.links > 1) return copy_into_place();
  if (place_.kind == OutputPlace::Kind::absent && beside_.empty() &&
      ::linkat(AT_FDCWD, link_of(descriptor_).c_str(), AT_FDCWD, place_.path.c_str(), AT_SYMLINK_FOLLOW) == 0)
    return;
  if (beside_.empty()) name_beside();
  if (::rename(beside_.c_str(), place_.path.c_str()) == 0) {
    beside_.clear();
  } else if (errno == EBUSY) {
    copy_into_place();
  } else {
    throw write_failure(place_.name, errno);
  }
}

void OutputFile::finish() {
  flush();
  if (!in_place_) put_in_place();
  const int closing = std::exchange(descriptor_, -1);
  // Some file systems report a full disk only here.
  if (closing != STDOUT_FILENO && ::close(closing) != 0) throw write_failure(place_.name, errno);
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  OutputFile output(file);
  output.write(bytes);
  output.finish();
}

}  // namespace palpa
