// `palpa emulate` as a program, and programs that break the rules of its boards: what it prints and writes.
#include <arpa/inet.h>
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/system/descriptor.hpp"
#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/sonicsurface/line.hpp"
#include "driver/usb/ftdi.hpp"
#include "driver/usb/local.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/occurrences.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// What an emulator prints and writes until SIGTERM ends it.
struct Emulated {
  std::string out, err;
  json report;
  int exit_code = -1;
};

/// `visit` gets the address, and does at least 21 things that break the board's rules. They are printed although
/// nothing comes afterwards.
Emulated emulate(const std::vector<std::string>& arguments, const std::function<void(const std::string&)>& visit) {
  const auto folder = scratch_folder("emulate-" + arguments[0]);
  const auto file = [&](const char* what) { return (folder / what).string(); };
  const Unread out = Unread::file(file("out")), err = Unread::file(file("err"));
  setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  LiveRun emulator(with(arguments, {"--json", file("report.json")}), {.out = &out, .err = &err, .command = "emulate"});
  const auto lines = [&] { return occurrences(read_text(file("out")), "\n"); };
  EXPECT_TRUE(begins([&] { return lines() == 1; }));
  const std::string address = read_text(file("out"));
  visit(address.substr(0, address.find('\n')));
  EXPECT_TRUE(begins([&] { return lines() == 1 + 20; })) << read_text(file("out"));
  emulator.signal(SIGTERM);
  const int exit_code = emulator.wait(60).exit_code;
  return {read_text(file("out")), read_text(file("err")), json::parse(read_text(file("report.json"))), exit_code};
}

/// The first 20 violations are printed one by one and written to JSON, and all are counted.
void expect_listed(const Emulated& end, const json& board, int violations) {
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_EQ(occurrences(end.out, " s: "), 20u) << end.out;
  EXPECT_EQ(board["violations"].size(), 20u);
  EXPECT_EQ(board["violation_count"], violations);
  for (const json& one : board["violations"])
    EXPECT_CONTAINS(end.out,
                    fmt::format("at {:.4f} s: {}\n", one["t_s"].get<double>(), one["what"].get<std::string>()));
  const json& first = board["violations"][0];
  EXPECT_CONTAINS(end.err, fmt::format("{} violations, the first at {:.4f} s: {}", violations,
                                       first["t_s"].get<double>(), first["what"].get<std::string>()));
}

TEST(Emulators, AServersViolationsAreListedAndCounted) {
  const Emulated end = emulate({"autd3", "--port", "0"}, [](const std::string& address) {
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    server.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1))));
    for (int i = 0; i < 13; ++i) {
      const Descriptor client(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
      ASSERT_EQ(connect(client.get(), reinterpret_cast<const sockaddr*>(&server), sizeof server), 0);
      const std::string hello = "\x10" + std::string(13, 'x');
      ASSERT_EQ(send(client.get(), hello.data(), hello.size(), MSG_NOSIGNAL), 14);
      std::array<char, 100> answer{};
      while (recv(client.get(), answer.data(), answer.size(), 0) > 0) {
      }
    }
  });
  expect_listed(end, end.report, 26);  // two each: another protocol's hello, and no goodbye
  EXPECT_EQ(end.report["operations"], 0);
  EXPECT_CONTAINS(end.out, "1 device, 0 operations each, silent\n");
}

TEST(Emulators, AGroupOfUnitsViolationsAreListedAndCounted) {
  const Emulated end =
      emulate({"autd3-udp", "--port", "0", "--protocol", "3", "--seed", "2"}, [](const std::string& to) {
        sockaddr_in6 group{};
        group.sin6_family = AF_INET6;
        group.sin6_addr = in6addr_loopback;
        ASSERT_EQ(to.substr(0, 6), "[::1]:");
        group.sin6_port = htons(static_cast<std::uint16_t>(std::stoi(to.substr(6))));
        const Descriptor host(socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        const auto say = [&](const std::string& datagram) {
          EXPECT_EQ(sendto(host.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&group),
                           sizeof group),
                    static_cast<ssize_t>(datagram.size()));
        };
        say({'\xff', 1, 5, 0});
        std::array<char, 100> answer{};
        sockaddr_in6 from{};
        socklen_t size = sizeof from;
        ASSERT_EQ(recvfrom(host.get(), answer.data(), answer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size), 5);
        EXPECT_EQ(std::string(answer.data(), 5), std::string({3, 1, 5, 0, 1})) << "its own protocol, and a refusal";
        EXPECT_NE(from.sin6_port, group.sin6_port) << "units have sockets of their own";
        for (int i = 0; i < 22; ++i)
          say({3, 7, 6, 0});
      });
  expect_listed(end, end.report, 22);  // heartbeats are for one unit
  EXPECT_EQ(end.report["frames"], 0);
  EXPECT_CONTAINS(end.out, "1 unit, 0 frames, silent\n");
}

TEST(Emulators, ASerialBoardsViolationsAreListedAndCounted) {
  PALPA_TERMINAL_OR_SKIP();
  std::unique_ptr<driver::sonicsurface::Line> line;
  const Emulated end = emulate({"sonicsurface"}, [&](const std::string& address) {
    line = std::make_unique<driver::sonicsurface::Line>(address);
    EXPECT_EQ(line->write(std::vector<std::uint8_t>(25, 150)), 25u);
  });
  expect_listed(end, end.report, 25);
  EXPECT_TRUE(end.report["sounds"].get<bool>()) << "since it was switched on";
  EXPECT_CONTAINS(end.out, "25 bytes, 0 swaps, sounding\n");
}

TEST(Emulators, AUsbBoardsViolationsAreListedAndCountedAndWhatSoundsWhenItIsLeft) {
  std::unique_ptr<driver::usb::Device> device;
  const Emulated end = emulate({"openmpd"}, [&](const std::string& address) {
    const auto open = [] {
      driver::usb::LocalTransport transport;
      driver::usb::Listing listing;
      EXPECT_TRUE(begins([&] {
        listing = transport.list([](std::uint16_t, std::uint16_t) { return true; });
        return !listing.entries.empty();
      }));
      return transport.open(listing.entries.at(0), driver::usb::ftdi::endpoint_out);
    };
    device = open();
    for (const auto& setup : driver::usb::ftdi::ready_requests)
      EXPECT_TRUE(begins([&] { return device->request(setup) == driver::usb::Outcome::done; })) << "or it is late";
    std::vector<std::uint8_t> frames;  // eight, which sound
    for (int i = 0; i < 8; ++i) {
      driver::openmpd::Frame frame = driver::openmpd::all_off_frame;
      frame[300] = driver::openmpd::full_width;
      frames.insert(frames.end(), frame.begin(), frame.end());
    }
    ASSERT_EQ(device->submit(0, frames), driver::usb::Outcome::done);
    ASSERT_TRUE(begins([&] { return device->reap().has_value(); }));
    const auto out = std::filesystem::path(address).parent_path().parent_path() / "out";
    const auto tells = [&](const char* what) {
      return begins([&] { return read_text(out).find(what) != std::string::npos; });
    };
    ASSERT_TRUE(tells("sound before the board was resynchronised")) << "it takes a second to come up";
    device.reset();
    ASSERT_TRUE(tells("left sounding by the program that had it open"));
    device = open();
    for (std::uint16_t i = 0; i < 23; ++i)
      EXPECT_EQ(device->request({0x40, 77, i, 0}), driver::usb::Outcome::stalled);
  });
  const json& board = end.report["boards"].at(0);
  expect_listed(end, board, 25);
  EXPECT_GE(board["most_buffered_bytes"], 512);
  EXPECT_TRUE(board["sounds"].get<bool>());
  EXPECT_CONTAINS(end.out, fmt::format("EMU1: {} frames, sounds, at most {} bytes waited\n", board["frames"].get<int>(),
                                       board["most_buffered_bytes"].get<int>()));
}

}  // namespace
}  // namespace palpa::test
