// OpenMPD boards in real time: the cost of a drive, and emulators behind sockets, as other processes use them.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/openmpd/openmpd_rig.hpp"
#include "driver/usb/local.hpp"
#include "driver/usb/local_server.hpp"
#include "driver/usb/system.hpp"
#include "support/begins.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"
#include "support/watched_heap.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
namespace usb = driver::usb;

TEST(OpenMpdCost, ADriveOfSixteenBoardsLeavesWithinAMillisecondAndAllocatesNothing) {
  OpenMpdRig rig;
  rig.take_sixteen();
  rig.slot_s = 250e-6;
  rig.open();
  array::Drive drive(rig.layout.transducers.size());
  for (std::size_t i = 0; i < drive.size(); ++i)
    drive[i] = {static_cast<float>(i % 97) / 96, static_cast<float>(i % 63) / 10 - 3.1f};
  std::vector<double> times;
  times.reserve(2000);
  const std::size_t allocations = allocations_of([&] {
    for (int i = 0; i < 2000; ++i) {
      const double begin_s = processor_s();
      rig.board->play(rig.slot++, drive);
      times.push_back(processor_s() - begin_s);
      rig.clock.sleep_s(rig.slot_s);
    }
  });
  EXPECT_EQ(allocations, 0u);
  EXPECT_TRUE(rig.board->in_step());
  std::sort(times.begin(), times.end());
  RecordProperty("median_us", static_cast<int>(1e6 * times[1000]));
  RecordProperty("p99_us", static_cast<int>(1e6 * times[1980]));
#if !defined(PALPA_ADDRESS_SANITIZER) && !defined(PALPA_THREAD_SANITIZER)
  // The emulators take their bytes on the same thread.
  EXPECT_LT(times[1000], 1e-3);
#endif
}

/// Prints nothing, so any allocation for its messages comes from the caller.
class DeafNotes final : public driver::BoardNotes {
 public:
  void warning(std::string_view) noexcept override { ++warnings; }
  void info(std::string_view) noexcept override {}
  void waits(std::string_view) noexcept override {}
  int warnings = 0;
};

TEST(OpenMpdCost, TroubleAllocatesNothingEither) {
  OpenMpdRig rig({"EMU1", "EMU2"});
  DeafNotes notes;
  rig.board = std::make_unique<openmpd::OpenMpdBoard>(
      driver::BoardSpec{rig.argument, rig.files, rig.layout, rig.slot_s}, notes, rig.bus, rig.clock);
  const array::Drive drive(512, {1, 0});
  rig.play(drive, 0.01);
  const std::size_t allocations = allocations_of([&] {
    rig.faults[1]->stalled = true;
    rig.play(drive, 2);
    rig.faults[1]->takes_nothing = true;
    rig.play(drive, 1);
    rig.faults[1]->takes_nothing = false;
    rig.faults[0]->refuses_requests = true;
    rig.play(drive, 1);
    rig.faults[0]->refuses_requests = false;
    rig.play(drive, 4);
    rig.faults[0]->unplugged = true;
    rig.play(drive, 0.1);  // until it is noticed
    rig.board->all_off();
  });
  EXPECT_EQ(allocations, 0u);
  EXPECT_EQ(notes.warnings, 5) << "out of step and back, twice, and gone";
}

/// Emulators behind sockets, with a thread that carries their bytes.
class Behind {
 public:
  explicit Behind(std::vector<openmpd::EmulatedBoard*> boards) {
    for (auto* board : boards)
      servers_.push_back(std::make_unique<usb::LocalServer>(*board, nullptr));
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        for (const auto& server : servers_)
          server->go_on([this] { return clock_.now_s() - begin_s_ + 3; });
        clock_.sleep_s(5e-4);
      }
    });
  }
  std::string address(std::size_t i) const { return servers_[i]->address().string(); }

 private:
  driver::SteadyClock clock_;
  double begin_s_ = clock_.now_s();
  std::vector<std::unique_ptr<usb::LocalServer>> servers_;
  std::jthread thread_;
};

bool any(std::uint16_t, std::uint16_t) {
  return true;
}

/// Once so many boards are listed: one that a busy machine delays is left out.
usb::Listing listed(usb::LocalTransport& transport, std::size_t boards) {
  usb::Listing listing;
  begins([&] {
    listing = transport.list(any);
    return listing.entries.size() >= boards;
  });
  return listing;
}

TEST(OpenMpdLocal, BoardsBehindSocketsAreListedAndOpenedByOneProgramAtATime) {
  const auto folder = scratch_folder("runtime");
  setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  openmpd::EmulatedBoard first("EMU1"), second("EMU2");
  usb::LocalTransport transport;
  {
    const Behind behind({&first, &second});
    EXPECT_EQ(behind.address(0), (folder / "palpa" / "usb-1.sock").string());
    const usb::Listing listing = listed(transport, 2);
    ASSERT_EQ(listing.entries.size(), 2u);
    EXPECT_EQ(listing.entries[1].serial, "EMU2");
    EXPECT_EQ(listing.entries[1].product, 0x6014);
    EXPECT_EQ(listing.entries[1].place, "emulated-2");
    // After one process had a board open, the next may open it at once, like the guard after one that died.
    for (int i = 0; i < 20; ++i)
      transport.open(listing.entries[0], 2).reset();
    const auto device = transport.open(listing.entries[0], 2);
    EXPECT_ERROR(transport.open(listing.entries[0], 2), Exit::failed, "another program");
  }
  EXPECT_TRUE(transport.list(any).entries.empty());
}

TEST(OpenMpdLocal, AnEmulatorThatEndsIsABoardThatIsGone) {
  const auto folder = scratch_folder("runtime-gone");
  setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  usb::LocalTransport transport;
  openmpd::EmulatedBoard board("EMU1");
  auto behind = std::make_unique<Behind>(std::vector{&board});
  const auto device = transport.open(listed(transport, 1).entries.at(0), 2);
  for (const usb::Setup& setup : usb::ftdi::ready_requests)
    EXPECT_TRUE(begins([&] { return device->request(setup) == usb::Outcome::done; })) << "or it is late";
  behind.reset();
  const openmpd::Frame frame = openmpd::all_off_frame;
  usb::Outcome outcome = device->submit(0, frame);
  if (outcome == usb::Outcome::done) {
    const auto sent = device->reap();
    ASSERT_TRUE(sent.has_value());
    outcome = sent->outcome;
  }
  EXPECT_EQ(outcome, usb::Outcome::gone);
  EXPECT_EQ(device->request(usb::ftdi::reset_request()), usb::Outcome::gone);
}

TEST(OpenMpdLocal, EmulatorsThatStartTogetherTakeTurns) {
  const auto folder = scratch_folder("runtime-race");
  setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  const auto first = usb::runtime_folder() / "usb-1.sock";
  const int lock = open((usb::runtime_folder() / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0) << "as one that looks for its address";
  openmpd::EmulatedBoard board("EMU1"), again("EMU1");
  std::vector<std::unique_ptr<usb::LocalServer>> servers(2);
  {
    std::jthread other([&] { servers[0] = std::make_unique<usb::LocalServer>(board, nullptr); });
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_FALSE(std::filesystem::exists(first));
    close(lock);
  }
  servers[1] = std::make_unique<usb::LocalServer>(again, nullptr);
  EXPECT_EQ(servers[0]->address(), first);
  EXPECT_EQ(servers[1]->address(), usb::runtime_folder() / "usb-2.sock");
  // The socket of a killed process belongs to nobody.
  const auto third = (usb::runtime_folder() / "usb-3.sock").string();
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  third.copy(name.sun_path, sizeof name.sun_path - 1);
  const int dead = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  ASSERT_EQ(bind(dead, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  close(dead);
  EXPECT_EQ(usb::LocalServer(board, nullptr).address(), third);
}

/// Lists the devices that it was created with, and says in its errors which transport was asked.
class Listed final : public usb::Transport {
 public:
  Listed(std::string name, usb::Listing listing) : name_(std::move(name)), listing_(std::move(listing)) {}
  usb::Listing list(usb::Wanted) override { return listing_; }
  std::unique_ptr<usb::Device> open(const usb::Entry&, std::uint8_t) override { throw failure(name_ + " was asked"); }

 private:
  std::string name_;
  usb::Listing listing_;
};

TEST(OpenMpdLocal, EmulatorsAreFoundBesideRealDevices) {
  usb::Entry real, emulated;
  real.bus = 3;
  emulated.bus = 1001;
  EXPECT_FALSE(usb::is_emulated(real));
  EXPECT_TRUE(usb::is_emulated(emulated));
  const auto both = [](usb::Listing of_usb, usb::Listing of_emulators) {
    return usb::with_emulators(std::make_unique<Listed>("USB", std::move(of_usb)),
                               std::make_unique<Listed>("an emulator", std::move(of_emulators)));
  };
  const auto found = both({{real}, "USB is odd"}, {{emulated}, ""});
  const usb::Listing listing = found->list(any);
  ASSERT_EQ(listing.entries.size(), 2u);
  EXPECT_EQ(listing.entries[0].bus, 3u);
  EXPECT_EQ(listing.entries[1].bus, 1001u);
  EXPECT_EQ(listing.problem, "") << "a machine without USB can play to emulators";
  EXPECT_ERROR(found->open(listing.entries[0], 2), Exit::failed, "USB was asked");
  EXPECT_ERROR(found->open(listing.entries[1], 2), Exit::failed, "an emulator was asked");
  EXPECT_EQ(both({{}, "no USB"}, {})->list(any).problem, "no USB");
  EXPECT_EQ(both({{}, "no USB"}, {{}, "no folder"})->list(any).problem, "no USB; no folder");
}

TEST(OpenMpdLocal, TheRuntimeFolderMustBeOnesOwn) {
  const auto folder = scratch_folder("runtime-open");
  setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  EXPECT_EQ(usb::runtime_folder(), folder / "palpa");
  std::filesystem::permissions(folder / "palpa", std::filesystem::perms(0755));
  EXPECT_ERROR(usb::runtime_folder(), Exit::failed, "0700");
  EXPECT_CONTAINS(usb::system_transport()->list(any).problem, "0700");
  const auto missing = folder / "not" / "there";
  setenv("XDG_RUNTIME_DIR", missing.c_str(), 1);
  EXPECT_ERROR(usb::runtime_folder(), Exit::failed, "cannot be created");
  const auto temporary = scratch_folder("runtime-temporary");
  unsetenv("XDG_RUNTIME_DIR");
  setenv("TMPDIR", temporary.c_str(), 1);
  EXPECT_EQ(usb::runtime_folder(), temporary / ("palpa-" + std::to_string(getuid())));
}

}  // namespace
}  // namespace palpa::test
