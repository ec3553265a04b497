#include "base/open_output.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <utility>

#include "base/error.hpp"
#include "base/file_register.hpp"
#include "base/log.hpp"

namespace palpa {
namespace {

using Clock = std::chrono::steady_clock;

/// Nanoseconds between two checks for a reader.
constexpr long slice_ns = 10'000'000;
/// A reader that is started together with palpa arrives sooner.
constexpr auto told_after = std::chrono::milliseconds(500);

thread_local const std::atomic<bool>* ends_waiting = nullptr;

/// Does not wait for a pipe's reader: without one, errno is ENXIO.
int try_to_open(const std::filesystem::path& file) {
  return ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
}

struct flock whole_file(short type) {
  struct flock whole {};
  whole.l_type = type;
  whole.l_whence = SEEK_SET;
  return whole;
}

Error written_by_another(const std::string& name) {
  return bad_usage(name + ": another palpa is writing this file; wait until it has ended");
}

/// Empties a regular file that nobody else writes. Without locks, it must be believed that nobody does.
void take(int descriptor, const OutputPlace& place) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return;
  lock_output(descriptor, place.name);
  if (status.st_size != 0 && ::ftruncate(descriptor, 0) != 0) throw write_failure(place.name, errno);
}

bool is_pipe(const std::filesystem::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
}

int wait_for_reader(const std::filesystem::path& file, const OutputPlace& place, ReaderPatience patience) {
  const Clock::time_point begin = Clock::now();
  bool told = false;
  for (;;) {
    // A signal that does not end the program ends the wait, just as it ends a call that opens such a pipe.
    const timespec slice{0, slice_ns};
    const bool signalled = ::nanosleep(&slice, nullptr) != 0 && errno == EINTR;
    const int descriptor = try_to_open(file);
    if (descriptor >= 0) return descriptor;
    if (errno != ENXIO) throw write_failure(place.name, errno);
    const auto waited = Clock::now() - begin;
    if (patience && waited > std::chrono::duration<double>(*patience))
      throw failure(place.name + ": nobody reads this pipe: start its reader first");
    if (signalled || (ends_waiting != nullptr && *ends_waiting))
      throw WaitEnded(Exit::failed, place.name + ": palpa was ended before anybody read this pipe");
    if (!patience && waited > told_after && !std::exchange(told, true))
      log::at_once(place.name + ": palpa waits for somebody to read this pipe");
  }
}

}  // namespace

WaitUntil::WaitUntil(const std::atomic<bool>& stop) : before_(std::exchange(ends_waiting, &stop)) {}

WaitUntil::~WaitUntil() {
  ends_waiting = before_;
}

int open_output(const std::filesystem::path& file, const OutputPlace& place, ReaderPatience patience) {
  file_register::writes(place);
  if (place.is_stdout) return STDOUT_FILENO;
  int descriptor = try_to_open(file);
  if (descriptor < 0 && errno == ENXIO && is_pipe(file)) descriptor = wait_for_reader(file, place, patience);
  if (descriptor < 0) throw write_failure(place.name, errno);
  try {
    take(descriptor, place);
  } catch (...) {
    ::close(descriptor);
    throw;
  }
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags >= 0) ::fcntl(descriptor, F_SETFL, flags & ~O_NONBLOCK);
  return descriptor;
}

bool lock_output(int descriptor, const std::string& name) {
  struct flock whole = whole_file(F_WRLCK);
  int result = 0;
  do {
    result = ::fcntl(descriptor, F_OFD_SETLK, &whole);
  } while (result < 0 && errno == EINTR);
  if (result < 0 && (errno == EAGAIN || errno == EACCES)) throw written_by_another(name);
  return result == 0;
}

void refuse_while_written(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return;
  struct flock whole = whole_file(F_WRLCK);
  const bool is_locked = ::fcntl(descriptor, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
  ::close(descriptor);
  if (is_locked) throw written_by_another(file.string());
}

int reopen_output(const OutputPlace& place) {
  const int descriptor = ::open(place.path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  if (descriptor < 0) throw write_failure(place.name, errno);
  return descriptor;
}

}  // namespace palpa
