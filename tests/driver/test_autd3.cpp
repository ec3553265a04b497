// AUTD3: what the encoder writes is what an independent reading of the protocol hears; and the board over TCP.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "driver/autd3/board.hpp"
#include "driver/autd3/device.hpp"
#include "driver/autd3/listen.hpp"
#include "driver/autd3/pattern.hpp"
#include "driver/autd3/server.hpp"
#include "driver/autd3/wire.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::autd3 {
namespace {

using namespace std::chrono_literals;
using Bytes = std::array<std::uint8_t, message_size>;
constexpr float pi = std::numbers::pi_v<float>;

TEST(Autd3Wire, PhasesAreDelaysAndIntensitiesAmplitudes) {
  EXPECT_EQ(emission({1.0f, 0.0f}), (Emission{0, 255}));
  EXPECT_EQ(emission({0.5f, pi}), (Emission{128, 128}));
  EXPECT_EQ(emission({0.0f, -pi / 2}), (Emission{192, 0}));
  EXPECT_EQ(emission({0.25f, -1e-4f}), (Emission{0, 64})) << "just below a whole turn";
  EXPECT_EQ(emission({1.5f, 2 * pi / 256}), (Emission{1, 255}));
  EXPECT_EQ(emission({1.0f, 2 * pi * 1.49f / 256}).phase, 1);
  EXPECT_EQ(emission({1.0f, 2 * pi * 1.51f / 256}).phase, 2);
}

/// A device that has been told to begin.
EmulatedDevice begun() {
  EmulatedDevice device;
  Bytes bytes{};
  put_clear_and_sync(bytes);
  device.receive(0, bytes);
  return device;
}

class Teller {
 public:
  explicit Teller(EmulatedDevice& device) : device_(device) {}
  template <typename Put>
  std::uint8_t tell(const Put& put, double now_s = 0) {
    Bytes bytes{};
    put(Message(bytes));
    set_id(bytes, static_cast<std::uint8_t>(++id_ % 16));
    device_.receive(now_s, bytes);
    EXPECT_EQ(device_.answer()[1] & 0x0f, id_ % 16);
    return device_.answer()[1] >> 4;
  }

 private:
  EmulatedDevice& device_;
  int id_ = 0;
};

std::vector<Emission> some(std::uint8_t seed, bool full = false) {
  std::vector<Emission> out(transducers);
  for (std::size_t t = 0; t < transducers; ++t)
    out[t] = {static_cast<std::uint8_t>(t * 7 + seed), full ? std::uint8_t{255} : static_cast<std::uint8_t>(t ^ seed)};
  return out;
}

testing::AssertionResult sounds(const EmulatedDevice& device, double at_s, const std::vector<Emission>& expected) {
  const auto heard = device.output(at_s);
  for (std::size_t t = 0; t < transducers; ++t) {
    if (heard[t].phase != expected[t].phase || heard[t].intensity != expected[t].intensity)
      return testing::AssertionFailure() << "transducer " << t << " at " << at_s << " s: " << int{heard[t].phase}
                                         << ", " << int{heard[t].intensity};
  }
  return testing::AssertionSuccess();
}

TEST(Autd3Wire, OneDriveSoundsAsItWasWritten) {
  EmulatedDevice device = begun();
  Teller teller(device);
  EXPECT_TRUE(device.silent(1));
  EXPECT_EQ(teller.tell([](Message m) { put_gain(m, 1, some(3)); }), 0);
  EXPECT_TRUE(sounds(device, 1, some(3)));
  EXPECT_EQ(teller.tell([](Message m) { put_silence(m, 0); }), 0);
  EXPECT_TRUE(device.silent(1));
  EXPECT_EQ(device.violations().count(), 0u);
}

TEST(Autd3Wire, APatternSoundsByTheDevicesClockOnceItIsWhole) {
  for (const bool full : {false, true}) {
    for (const std::uint32_t parts : {2u, 3u, 10u, 65u}) {
      EmulatedDevice device = begun();
      Teller teller(device);
      const std::uint32_t each = full ? 2 : 1;
      for (std::uint32_t p = 0; p < parts; p += each) {
        EXPECT_TRUE(device.silent(1)) << "nothing of it sounds before its end";
        const PatternStep step{1, 60, p == 0, p + each >= parts};
        const auto part = some(static_cast<std::uint8_t>(p), full), next = some(static_cast<std::uint8_t>(p + 1), full);
        const std::span<const Emission> second = p + 1 < parts ? std::span(next) : std::span<const Emission>();
        EXPECT_EQ(teller.tell([&](Message m) {
          full ? put_pattern_phases(m, step, part, second) : put_pattern(m, step, part);
        }),
                  0);
      }
      for (std::uint32_t p = 0; p < 2 * parts; ++p)
        EXPECT_TRUE(sounds(device, (p + 0.5) * 1.5e-3, some(static_cast<std::uint8_t>(p % parts), full)));
      EXPECT_EQ(device.violations().count(), 0u);
    }
  }
}

TEST(Autd3Wire, AModulationIsHeardByTheDevicesClock) {
  EmulatedDevice device = begun();
  Teller teller(device);
  const std::vector<Emission> loud(transducers, {7, 200});
  teller.tell([&](Message m) { put_gain(m, 1, loud); });
  const ModulationSamples samples = modulation_samples(200, array::Modulation::amplitude_sine, 100, 1000, 100.4);
  EXPECT_EQ(samples.count, 20u);
  EXPECT_EQ(teller.tell([&](Message m) {
    put_modulation(m, 1, samples.divider, std::span(samples.samples).first(samples.count));
  }),
            0);
  // Slot 0 began at 100 on the loop's clock, 1000 before that began the day.
  for (int i = 0; i < 40; ++i) {
    const double after_s = 3 + (i + 0.5) / 4000;
    const double gain = array::modulation_gain(array::Modulation::amplitude_sine, 200, after_s);
    EXPECT_NEAR(device.output(100 + 1000 - epoch_s + 2 * epoch_s + after_s)[5].intensity, 200 * gain, 1.2) << i;
  }
  for (const double hz : {1000 / 15.0, 199.0, 120.5}) {
    const ModulationSamples odd = modulation_samples(hz, array::Modulation::pressure_sine, 0, 0, 1);
    const double cycles = static_cast<double>(odd.count) * hz / 4000;
    EXPECT_NEAR(cycles, std::round(cycles), 0.02 * cycles) << hz;
  }
  EXPECT_EQ(device.violations().count(), 0u);
}

TEST(Autd3Emulator, RefusesWhatTheFirmwareRefuses) {
  const auto part = some(1);
  {
    EmulatedDevice fresh;
    Teller(fresh).tell([&](Message m) { put_gain(m, 1, part); });
    EXPECT_EQ(fresh.violations().count(), 1u) << "before clear and sync";
  }
  EmulatedDevice device = begun();
  Teller teller(device);
  EXPECT_EQ(teller.tell([&](Message m) {
    put_pattern(m, {1, 39, true, false}, part);
  }),
            7)
      << "faster than its silencer";
  EXPECT_EQ(teller.tell([](Message m) { put_silencer(m, 10, 30); }), 0);
  EXPECT_EQ(teller.tell([&](Message m) { put_pattern(m, {1, 39, true, false}, part); }), 0);
  std::size_t count = device.violations().count();
  EXPECT_EQ(count, 1u);
  teller.tell([&](Message m) { put_pattern(m, {0, 60, true, false}, part); });
  EXPECT_GT(device.violations().count(), count) << "into the segment that sounds";
  count = device.violations().count();
  EXPECT_EQ(teller.tell([&](Message m) { put_pattern(m, {1, 60, false, true}, part); }), 5) << "no beginning";
  EXPECT_GT(device.violations().count(), count);
  EXPECT_EQ(teller.tell([](Message m) { m[4] = 0x77; }), 1);
}

std::vector<std::uint8_t> geometry(std::uint32_t count) {
  std::vector<std::uint8_t> out{0x01, static_cast<std::uint8_t>(count), 0, 0, 0};
  for (std::uint32_t d = 0; d < count; ++d) {
    out.insert(out.end(), 12, 0);
    for (const float value : {1.0f, 0.0f, 0.0f, 0.0f}) {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
      out.insert(out.end(), bytes, bytes + 4);
    }
  }
  return out;
}

TEST(Autd3Emulator, TakesRequestsHoweverTheyAreCut) {
  std::vector<std::uint8_t> all(hello_request.begin(), hello_request.end());
  const auto add = [&](const std::vector<std::uint8_t>& more) { all.insert(all.end(), more.begin(), more.end()); };
  add(geometry(2));
  std::vector<std::uint8_t> send(1 + 2 * message_size);
  send[0] = 0x03;
  send[1] = send[1 + message_size] = 5;
  add(send);
  add({0x04, 0x05});
  const std::vector<std::uint8_t> expected{0, 0, 0, 0, 0, 5, 0, 5, 0};
  for (std::size_t cut = 0; cut < all.size(); cut += cut < 90 ? 1 : 41) {
    EmulatedServer server(2);
    std::vector<std::uint8_t> answer;
    server.welcome();
    EXPECT_TRUE(server.take(0, std::span(all).first(cut), answer));
    EXPECT_FALSE(server.take(0, std::span(all).subspan(cut), answer)) << "a goodbye is the end";
    EXPECT_EQ(answer, expected) << cut;
    EXPECT_EQ(server.violation_count(), 0u);
  }
}

TEST(Autd3Emulator, RefusesRequestsOutOfOrder) {
  const std::vector<std::uint8_t> hello(hello_request.begin(), hello_request.end());
  auto newer = hello, other = hello;
  newer[1] = 2;
  other[5] = 'X';
  for (const auto& wrong : {newer, other, geometry(1), std::vector<std::uint8_t>{0x04}}) {
    EmulatedServer server(1);
    std::vector<std::uint8_t> answer;
    EXPECT_FALSE(server.take(0, wrong, answer));
    EXPECT_EQ(answer.at(0), 0xff);
    EXPECT_EQ(server.violation_count(), 1u);
  }
  EmulatedServer server(1);
  std::vector<std::uint8_t> answer;
  EXPECT_TRUE(server.take(0, hello, answer));
  EXPECT_FALSE(server.take(0, geometry(2), answer));
}

class Told final : public BoardNotes {
 public:
  void warning(std::string_view line) noexcept override { warnings.emplace_back(line); }
  void info(std::string_view line) noexcept override { infos.emplace_back(line); }
  std::vector<std::string> warnings, infos;
};

/// An emulated server that is there while this lives.
class Serving {
 public:
  /// `late` is how long it lets every request wait.
  explicit Serving(EmulatedServer& server, std::uint16_t port = 0, std::chrono::milliseconds late = 0ms)
      : listener_(port) {
    thread_ = std::thread([this, &server, late] {
      listener_.serve(server, stop_, lock, [late](auto) { std::this_thread::sleep_for(late); });
    });
  }
  ~Serving() {
    stop_ = true;
    thread_.join();
  }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  std::string address() const { return listener_.address(); }
  std::uint16_t port() const { return listener_.port(); }
  std::mutex lock;

 private:
  Listener listener_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A board on it, as its guard has it.
struct Rig {
  array::Layout layout;
  EmulatedServer server;
  std::unique_ptr<Serving> serving;
  std::string argument, files;
  Told notes;
  std::unique_ptr<Board> board;
  array::Drive drives, silence;
  std::uint64_t slot = 1000;

  explicit Rig(const std::string& name = "autd3")
      : layout(array::load_layout(name)), server(layout.boards.size()), serving(std::make_unique<Serving>(server)) {
    argument = serving->address();
    drives.resize(10 * layout.transducers.size());
    for (std::size_t i = 0; i < drives.size(); ++i)
      drives[i] = {static_cast<float>(i % 97 + 1) / 97, static_cast<float>(static_cast<double>(i % 61) / 10 - 3)};
    silence.assign(layout.transducers.size(), {0.0f, 0.0f});
  }
  std::unique_ptr<Board> make(double slot_s = 1.5e-3) {
    return board_kind().open({argument, files, layout, slot_s, notes});
  }
  void open() { board = make(); }
  std::span<const array::TransducerDrive> part(std::uint64_t s) const {
    return std::span(drives).subspan((s % 10) * silence.size(), silence.size());
  }
  /// When the plan's first slot begins, as the devices count.
  double plan(double hz = 0) {
    double from_s = monotonic_s(), device_s = device_time_s();
    while (monotonic_s() > from_s + 20e-6) {  // both at one time
      from_s = monotonic_s();
      device_s = device_time_s();
    }
    board->plan({slot, slot + 1000000, from_s, 1.5e-3, 10, drives, hz, array::Modulation::amplitude_sine});
    return device_s;
  }
  /// As a guard does between drives.
  template <typename Done>
  bool tend_until(const Done& done, std::chrono::milliseconds at_most = 3000ms) {
    for (const auto end = std::chrono::steady_clock::now() + at_most; std::chrono::steady_clock::now() < end;) {
      board->tend();
      {
        const std::lock_guard held(serving->lock);
        if (done()) return true;
      }
      std::this_thread::sleep_for(200us);
    }
    return false;
  }
  bool silent() const { return server.silent(device_time_s()); }
  bool falls_silent() {
    return tend_until([&] { return silent(); });
  }
  bool sounds() {
    return tend_until([&] { return !silent(); });
  }
};

/// Each device emits one whole part of the pattern.
int part_heard(const Rig& rig, double at_s) {
  for (std::uint64_t p = 0; p < 10; ++p) {
    bool all = true;
    for (std::size_t d = 0; d < rig.server.devices().size() && all; ++d) {
      const auto heard = rig.server.devices()[d].output(at_s);
      for (std::size_t t = 0; t < transducers && all; ++t) {
        const Emission e = emission(rig.part(p)[d * transducers + t]);
        all = heard[t].phase == e.phase && heard[t].intensity == e.intensity;
      }
    }
    if (all) return static_cast<int>(p);
  }
  return -1;
}

TEST(Autd3Board, PlaysAPlanFromTheSlotThatIsRunning) {
  for (const std::string name : {"autd3", "paper"}) {
    Rig rig(name);
    rig.open();
    ASSERT_EQ(rig.server.poses().size(), rig.layout.boards.size());
    EXPECT_TRUE(rig.silent());
    const double told_s = rig.plan();
    ASSERT_TRUE(rig.sounds());
    {
      const std::lock_guard held(rig.serving->lock);
      for (int s = 0; s < 25; ++s) {
        // The two clocks are rounded to whole slots: the middle of a slot is within half a slot of the same part.
        const double middle_s = told_s + (100 + s + 0.5) * 1.5e-3;
        const int before = part_heard(rig, middle_s - 0.75e-3), after = part_heard(rig, middle_s + 0.7e-3);
        const int expected = static_cast<int>((rig.slot + 100 + s) % 10);
        EXPECT_TRUE(before == expected || after == expected)
            << name << ": " << before << " or " << after << ", not " << expected;
      }
    }
    rig.board->play(++rig.slot, rig.silence);
    EXPECT_TRUE(rig.falls_silent());
    EXPECT_TRUE(rig.board->close());
    rig.board.reset();
    EXPECT_EQ(rig.server.violation_count(), 0u) << rig.server.violations()[0].what;
    ASSERT_EQ(rig.notes.infos.size(), 1u);
    EXPECT_CONTAINS(rig.notes.infos[0], "1 of 1 plans brought over");
    EXPECT_TRUE(rig.notes.warnings.empty());
  }
}

TEST(Autd3Board, TheNewestPlanWinsAndNoneQueues) {
  Rig rig;
  rig.open();
  for (int i = 0; i < 40; ++i) {
    rig.drives[0].amplitude = static_cast<float>(i) / 100;
    rig.plan();
  }
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0.5 * 1.5e-3) >= 0; })) << "the last of them";
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
  EXPECT_LT(rig.server.devices()[0].transitions(), 30u);
  EXPECT_EQ(rig.server.violation_count(), 0u);
}

TEST(Autd3Board, ADriveOfNothingSilencesUnlessThePatternHasIt) {
  Rig rig;
  std::fill_n(rig.drives.begin() + 4 * transducers, transducers, array::TransducerDrive{0, 0});
  rig.open();
  rig.plan();
  ASSERT_TRUE(rig.sounds());
  const std::uint64_t transitions = rig.server.devices()[0].transitions();
  rig.slot = 2004;
  rig.board->play(rig.slot, rig.silence);
  rig.tend_until([] { return false; }, 30ms);
  EXPECT_EQ(rig.server.devices()[0].transitions(), transitions) << "the pattern has a pause there";
  rig.board->play(rig.slot + 1, rig.silence);
  EXPECT_TRUE(rig.tend_until([&] { return rig.server.devices()[0].transitions() > transitions && rig.silent(); }));
  // And it comes back with the next drive that sounds: after SIGCONT nobody tells the plan again.
  rig.board->play(rig.slot + 2, rig.part(rig.slot + 2));
  EXPECT_TRUE(rig.sounds());
  rig.board->all_off();
  EXPECT_TRUE(rig.falls_silent());
  rig.tend_until([] { return false; }, 30ms);
  EXPECT_TRUE(rig.silent());
  EXPECT_TRUE(rig.board->close());
  EXPECT_EQ(rig.server.violation_count(), 0u);
}

TEST(Autd3Board, DrivesWithoutAPlanComeOneByOne) {
  Rig rig;
  rig.open();
  rig.board->play(1, rig.part(1));
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0) == 1; }));
  for (std::uint64_t s = 2; s < 30; ++s)
    rig.board->play(s, rig.part(s));
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0) == 9; }));
  rig.board->play(30, rig.silence);
  EXPECT_TRUE(rig.falls_silent());
  EXPECT_TRUE(rig.board->close());
  EXPECT_EQ(rig.server.violation_count(), 0u);
}

TEST(Autd3Board, FullAmplitudesTakeHalfTheMessagesAndAModulationOneMore) {
  Rig rig;
  rig.open();
  const std::uint64_t before = rig.server.devices()[0].operations();
  for (auto& drive : rig.drives)
    drive.amplitude = 1;
  rig.plan(200);
  ASSERT_TRUE(rig.tend_until([&] { return rig.server.devices()[0].transitions() == 2; }));
  EXPECT_EQ(rig.server.devices()[0].operations() - before, 1u + 5 + 1);  // modulation, pairs, transition
  std::uint8_t least = 255, most = 0;
  for (int i = 0; i < 20; ++i) {
    const auto heard = rig.server.devices()[0].output((i + 0.5) / 4000)[0].intensity;
    least = std::min(least, heard);
    most = std::max(most, heard);
  }
  EXPECT_LT(least, 5);
  EXPECT_GT(most, 250);
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
  EXPECT_EQ(rig.server.violation_count(), 0u);
}

TEST(Autd3Board, RefusesWhatItCannotPlay) {
  Rig rig;
  EXPECT_CONTAINS(test::error_of([&] { rig.make(0.1e-3 / 3); }, Exit::usage), "whole number of periods");
  rig.argument = "nowhere";
  EXPECT_CONTAINS(test::error_of([&] { rig.make(); }, Exit::usage), "HOST:PORT");
  rig.argument = "127.0.0.1:1";
  EXPECT_CONTAINS(test::error_of([&] { rig.make(); }, Exit::failed), "127.0.0.1:1 is not there: Connection refused");
  Rig two("paper");
  two.argument = Rig().argument;
  Rig small;
  two.argument = small.argument;
  EXPECT_CONTAINS(test::error_of([&] { two.make(); }, Exit::failed), "refuses: a geometry of 16 devices, there are 1");
  Rig other("openmpd");
  EXPECT_CONTAINS(test::error_of([&] { other.make(); }), "AUTD3 units only");
  Rig old;
  old.serving.reset();
  old.server = EmulatedServer(1, 0xa3);
  old.serving = std::make_unique<Serving>(old.server);
  old.argument = old.serving->address();
  EXPECT_CONTAINS(test::error_of([&] { old.make(); }, Exit::failed), "device 0 has firmware 0xa3");
}

TEST(Autd3Board, AServerThatComesBackIsSilencedBeforeItSounds) {
  Rig rig;
  rig.open();
  rig.plan();
  ASSERT_TRUE(rig.sounds());
  const std::uint16_t port = rig.serving->port();
  rig.serving.reset();  // the devices sound on
  EXPECT_FALSE(rig.silent());
  for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(1ms)) {
    ++rig.slot;
    rig.board->play(rig.slot, rig.part(rig.slot));
    rig.board->tend();
  }
  ASSERT_EQ(rig.notes.warnings.size(), 1u) << "told once";
  rig.serving = std::make_unique<Serving>(rig.server, port);
  ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 2; }));
  EXPECT_CONTAINS(rig.notes.warnings[1], "is there again");
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0) >= 0; }));
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
  EXPECT_TRUE(rig.silent());
}

TEST(Autd3Board, ASlowServerHearsTheNewestPlanAndSilenceInTime) {
  Rig rig;
  rig.serving.reset();
  rig.serving = std::make_unique<Serving>(rig.server, 0, 3ms);
  rig.argument = rig.serving->address();
  rig.open();
  for (int i = 0; i < 40; ++i) {  // a frame each 4 ms, a plan takes 60 to come over
    rig.drives[0].amplitude = static_cast<float>(i) / 100;
    rig.plan();
    rig.tend_until([] { return false; }, 4ms);
  }
  EXPECT_LT(rig.server.devices()[0].transitions(), 8u);
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0.5 * 1.5e-3) >= 0; })) << "the last of them";
  const auto begin = std::chrono::steady_clock::now();
  const std::uint64_t operations = rig.server.devices()[0].operations();
  rig.plan();
  rig.board->play(rig.slot, rig.silence);
  EXPECT_TRUE(rig.falls_silent());
  EXPECT_LE(rig.server.devices()[0].operations() - operations, 2u) << "silence waits for one message at most";
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 1s);
  EXPECT_TRUE(rig.board->close());
  EXPECT_TRUE(rig.notes.warnings.empty());
  EXPECT_EQ(rig.server.violation_count(), 0u);
}

/// A server that answers as it likes, once.
class Stranger {
 public:
  explicit Stranger(std::string answer, bool stays)
      : answer_(std::move(answer)), stays_(stays), socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(socket_.get(), 1), 0);
    getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] {
      client_ = Descriptor(accept(socket_.get(), nullptr, nullptr));
      std::array<char, 64> bytes{};
      recv(client_.get(), bytes.data(), bytes.size(), 0);
      send(client_.get(), answer_.data(), answer_.size(), MSG_NOSIGNAL);
      if (!stays_) client_ = Descriptor();
    });
  }
  ~Stranger() { thread_.join(); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  const std::string& address() const { return address_; }

 private:
  std::string answer_, address_;
  bool stays_;
  Descriptor socket_, client_;
  std::thread thread_;
};

TEST(Autd3Board, AServerThatLiesOrIsSilentIsGivenUp) {
  Rig rig;
  const auto line_for = [&](const std::string& answer, bool stays) {
    const Stranger stranger(answer, stays);
    rig.argument = stranger.address();
    return test::error_of([&] { rig.make(); }, Exit::failed);
  };
  EXPECT_CONTAINS(line_for("HTTP/1.1 400", true), "does not speak AUTD3's Remote protocol");
  EXPECT_CONTAINS(line_for("", true), "does not answer");
  EXPECT_CONTAINS(line_for("", false), "has ended the connection");
  EXPECT_CONTAINS(line_for(std::string("\xff\xff\xff\xff\xff", 5) + std::string(1000, 'x'), true), "refuses: xxx");
  EXPECT_CONTAINS(line_for(std::string("\xff\x10\0\0\0too short", 14), false), "has ended the connection");
}

TEST(Autd3Board, AShortRefusalWithMoreBehindItIsARefusal) {
  Rig rig("paper");
  // Hello, geometry and a message are answered well; instead of the devices' answers there is a refusal without a text,
  // and much that nobody asked for.
  const Stranger stranger(std::string("\0\0\0\xff\0\0\0\0", 8) + std::string(4000, 'x'), true);
  rig.argument = stranger.address();
  EXPECT_CONTAINS(test::error_of([&] { rig.make(); }, Exit::failed), "refuses");
}

}  // namespace
}  // namespace palpa::driver::autd3
