#include "base/locked_bytes.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/error.hpp"
#include "base/output_place.hpp"

namespace palpa {

LockedBytes::LockedBytes(const std::filesystem::path& file) : file_(file) {
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw write_failure(file.string(), errno);
  // A byte that nobody else uses shows whether the file system has locks at all.
  try {
    constexpr std::uint64_t unused = std::uint64_t{1} << 60;
    if (try_lock(unused)) unlock(unused);
  } catch (...) {
    close(descriptor_);
    throw;
  }
  kept_.emplace(descriptor_);
}

LockedBytes::~LockedBytes() {
  kept_.reset();
  close(descriptor_);
}

bool LockedBytes::change(std::uint64_t byte, short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(byte);
  lock.l_len = 1;
  // The lock belongs to the open file, not to the process: two objects of one process exclude each other, too.
  int result = 0;
  do {
    result = fcntl(descriptor_, F_OFD_SETLK, &lock);
  } while (result < 0 && errno == EINTR);
  if (result == 0) return true;
  if (errno == EAGAIN || errno == EACCES) return false;
  throw failure(file_.string() + ": cannot be locked: " + std::system_category().message(errno) +
                "; use a folder on a file system with locks");
}

bool LockedBytes::try_lock(std::uint64_t byte) {
  return change(byte, F_WRLCK);
}

void LockedBytes::unlock(std::uint64_t byte) {
  change(byte, F_UNLCK);
}

void LockedBytes::mark(std::uint64_t byte) {
  const char set = '1';
  ssize_t written = 0;
  do {
    written = pwrite(descriptor_, &set, 1, static_cast<off_t>(byte));
  } while (written < 0 && errno == EINTR);
  if (written != 1) throw write_failure(file_.string(), errno);
}

bool LockedBytes::is_marked(std::uint64_t byte) const {
  char set = 0;
  return pread(descriptor_, &set, 1, static_cast<off_t>(byte)) == 1 && set == '1';
}

}  // namespace palpa
