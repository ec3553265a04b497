#include "driver/sonicsurface/line.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"

namespace palpa::driver::sonicsurface {
namespace {

/// Keeps other programs from the line until this one closes it or is gone. Returns an errno if another program has it.
int take_alone(int fd) {
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) return errno == EWOULDBLOCK ? EBUSY : errno;
  // The kernel keeps out programs that ask for no lock. Not used for a pseudo terminal, because it would stay closed to
  // ordinary users as long as its emulator lives.
  struct stat status {};
  constexpr unsigned first_pty = 136, last_pty = 143;
  if (fstat(fd, &status) != 0) return errno;
  const unsigned driver = major(status.st_rdev);
  if (driver >= first_pty && driver <= last_pty) return 0;
  return ioctl(fd, TIOCEXCL) != 0 ? errno : 0;
}

}  // namespace

Line::Line(std::string path) : path_(std::move(path)) {
  int fault = open();
  // The guard of a run that has just ended may still be closing it.
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  while (fault == EBUSY && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    fault = open();
  }
  if (fault == 0) return;
  const char* advice = fault == EACCES   ? "; add yourself to the group dialout and log in again"
                       : fault == ENOTTY ? "; give the board's serial port, such as /dev/ttyUSB0"
                       : fault == EBUSY  ? "; another program has it"
                                         : "";
  throw failure(fmt::format("{}: {}{}", path_, std::strerror(fault), advice));
}

int Line::open() {
  Descriptor fd(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!fd) return errno;
  termios setting{};
  if (tcgetattr(fd.get(), &setting) != 0) return errno;
  if (const int fault = take_alone(fd.get()); fault != 0) return fault;
  cfmakeraw(&setting);
  setting.c_cflag |= CLOCAL | CREAD;
  setting.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | HUPCL | CSTOPB | PARENB);
  cfsetspeed(&setting, B230400);
  if (tcsetattr(fd.get(), TCSANOW, &setting) != 0) return errno;
  // A line silently ignores settings that it does not support.
  if (tcgetattr(fd.get(), &setting) != 0) return errno;
  if (cfgetospeed(&setting) != B230400) return EINVAL;
  fd_ = std::move(fd);
  return 0;
}

bool Line::reopen() {
  return open() == 0;
}

std::size_t Line::write(std::span<const std::uint8_t> bytes) {
  if (gone() || bytes.empty()) return 0;
  const ssize_t size = ::write(fd_.get(), bytes.data(), bytes.size());
  if (size >= 0) return static_cast<std::size_t>(size);
  if (errno != EAGAIN && errno != EINTR) fd_ = Descriptor();
  return 0;
}

void Line::drop() {
  if (!gone()) tcflush(fd_.get(), TCOFLUSH);
}

bool Line::drained() const {
  int waiting = 0;
  return !gone() && ioctl(fd_.get(), TIOCOUTQ, &waiting) == 0 && waiting == 0;
}

}  // namespace palpa::driver::sonicsurface
