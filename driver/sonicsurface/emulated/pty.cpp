#include "driver/sonicsurface/emulated/pty.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "base/system/now.hpp"

namespace palpa::driver::sonicsurface {
namespace {

constexpr int look_ms = 20;
/// A serial port delivers its bytes one by one, at the boards' speed. It reads few at a time, so that their time is
/// short.
constexpr std::size_t most_at_once = 64;
constexpr double byte_s = 10 / 227556.0;

double baud_of(int terminal) {
  constexpr double unknown = 0;
  termios setting{};
  if (tcgetattr(terminal, &setting) != 0) return unknown;
  switch (cfgetospeed(&setting)) {
    case B115200:
      return 115200;
    case B230400:
      return 230400;
    case B460800:
      return 460800;
    default:
      return unknown;
  }
}

}  // namespace

Pty::Pty() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  std::array<char, 64> name{};
  if (!master_ || grantpt(master_.get()) != 0 || unlockpt(master_.get()) != 0 ||
      ptsname_r(master_.get(), name.data(), name.size()) != 0)
    throw failure(fmt::format("cannot open a pseudo terminal: {}", std::strerror(errno)));
  path_ = name.data();
  slave_ = Descriptor(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!slave_) throw failure(fmt::format("{}: {}", path_, std::strerror(errno)));
  termios raw{};
  tcgetattr(master_.get(), &raw);
  cfmakeraw(&raw);
  tcsetattr(master_.get(), TCSANOW, &raw);
}

void Pty::serve(EmulatedBoards& boards, const std::atomic<bool>& stop, std::mutex& lock,
                const std::function<void(std::span<const std::uint8_t>)>& heard) const {
  std::array<std::uint8_t, most_at_once> bytes{};
  double taken_s = 0;  // when the last bytes were there
  bool rested = true;
  double baud = 0;  // of the program that has the line
  while (!stop) {
    pollfd one{master_.get(), POLLIN, 0};
    // If bytes wait, the line has not rested since the last ones, however late this thread comes to take them.
    rested = rested || poll(&one, 1, 0) == 0;
    if (rested && poll(&one, 1, look_ms) <= 0) {
      if (heard) heard({});
      continue;
    }
    const ssize_t size = read(master_.get(), bytes.data(), bytes.size());
    if (size <= 0) continue;
    const std::span<const std::uint8_t> came(bytes.data(), static_cast<std::size_t>(size));
    if (std::exchange(rested, false)) taken_s = monotonic_s();
    taken_s += static_cast<double>(size) * byte_s;
    std::this_thread::sleep_for(std::chrono::duration<double>(taken_s - monotonic_s()));
    if (heard) heard(came);
    const std::lock_guard held(lock);
    if (const double now = baud_of(master_.get()); std::exchange(baud, now) != now) boards.set_baud(monotonic_s(), now);
    boards.take(monotonic_s(), came);
  }
}

}  // namespace palpa::driver::sonicsurface
