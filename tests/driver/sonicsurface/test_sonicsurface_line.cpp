// SonicSurface's serial line in real time: its emulator's speed, and programs that take turns on it.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "base/system/now.hpp"
#include "driver/sonicsurface/emulated/pty.hpp"
#include "driver/sonicsurface/line.hpp"
#include "driver/sonicsurface/wire.hpp"
#include "sonicsurface_rig.hpp"
#include "support/ordinary_user.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::sonicsurface {
namespace {

TEST(SonicSurfaceEmulator, TakesBytesAtTheSpeedOfItsPort) {
  PALPA_TERMINAL_OR_SKIP();
  test::SonicSurfaceLine line;
  Line port(line.path());
  const std::vector<std::uint8_t> bytes(1000, swap);
  const double begin_s = monotonic_s();
  ASSERT_EQ(port.write(bytes), bytes.size());
  EXPECT_TRUE(test::becomes(line.lock, [&] { return line.machine.swaps() == bytes.size(); }));
  EXPECT_GE(monotonic_s() - begin_s, 0.9 * seconds_of(bytes.size()));
}

TEST(SonicSurfaceEmulator, TakesAllThatWasWrittenBeforeTheLineIsClosed) {
  PALPA_TERMINAL_OR_SKIP();
  test::SonicSurfaceLine line;
  const std::vector<std::uint8_t> bytes(500, swap);
  for (std::uint64_t program = 1; program <= 5; ++program) {
    ASSERT_EQ(Line(line.path()).write(bytes), bytes.size());
    EXPECT_TRUE(test::becomes(line.lock, [&] { return line.machine.swaps() == program * bytes.size(); }));
  }
  const std::lock_guard held(line.lock);
  EXPECT_EQ(line.machine.violations().count(), 0U);
}

TEST(SonicSurfaceLine, OnlyOneProgramCanOpenIt) {
  PALPA_TERMINAL_OR_SKIP();
  const Pty pty;
  ASSERT_EQ(chmod(pty.path().c_str(), 0666), 0);
  const test::OrdinaryUser user;  // root can open lines that other users cannot
  auto line = std::make_unique<Line>(pty.path());
  EXPECT_ERROR(Line(pty.path()), Exit::failed, "another program has it");
  line.reset();
  EXPECT_NO_THROW(Line(pty.path())) << "the program before has closed it";
}

}  // namespace
}  // namespace palpa::driver::sonicsurface
