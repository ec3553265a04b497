// AUTD3: the board over TCP, with emulated units.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "autd3_rig.hpp"
#include "base/system/descriptor.hpp"
#include "base/system/now.hpp"
#include "driver/autd3/board.hpp"
#include "driver/autd3/emulated/listener.hpp"
#include "driver/autd3/emulated/server.hpp"
#include "driver/autd3/remote.hpp"
#include "driver/autd3/wire.hpp"
#include "driver/plan_tally.hpp"
#include "support/begins.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::autd3 {
namespace {

using namespace std::chrono_literals;
using test::part_heard;
using Rig = test::Autd3Rig;
using Opened = test::Opened<Rig>;
using Serving = test::Autd3Serving;

/// Adds a focus, at full amplitude, and the phases of its distances.
void aim(Rig& rig, const Vec3& focus) {
  const std::size_t first = rig.foci.size() * rig.silence.size();
  rig.foci.push_back(focus);
  for (std::size_t t = 0; t < rig.silence.size(); ++t) {
    const double turns = -glm::length(focus - rig.layout.transducers[t].position) * 40e3 / rig.sound_speed_m_s;
    rig.drives[first + t] = {1.0f, static_cast<float>(2 * std::numbers::pi * (turns - std::round(turns)))};
  }
}

TEST(Autd3Board, PlaysAPlanFromTheSlotThatIsRunning) {
  for (const std::string name : {"autd3", "paper"}) {
    Rig rig(name);
    rig.open();
    ASSERT_EQ(rig.server.poses().size(), rig.layout.boards.size());
    EXPECT_TRUE(rig.silent());
    const double planned_s = rig.plan();
    ASSERT_TRUE(rig.sounds());
    {
      const std::lock_guard held(rig.serving->lock);
      for (int s = 0; s < 25; ++s) {
        // The two clocks are rounded to whole slots: the middle of a slot is within half a slot of the same part.
        const double middle_s = planned_s + (100 + s + 0.5) * 1.5e-3;
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
    EXPECT_CONTAINS(rig.notes.infos[0], "1 of 1 plans transferred");
    EXPECT_TRUE(rig.notes.warnings.empty());
  }
}

TEST(Autd3Board, PhasesChangeDuringTheWholeSlotAndNoLonger) {
  for (const auto& [slot_s, phase, intensity] :
       {std::tuple(1.5e-3, 60, 10), {0.1e-3, 4, 4}, {0.25e-3, 10, 10}, {6.375e-3, 255, 10}, {6.4e-3, 255, 10}}) {
    for (const bool nulls : {false, true}) {
      Rig rig;
      rig.nulls = nulls;
      const auto board = rig.make(slot_s);
      ASSERT_EQ(rig.notes.warnings.size(), nulls ? 1u : 0u);
      if (nulls) {
        EXPECT_CONTAINS(rig.notes.warnings[0], "with nulls, phases jump from drive to drive");
      }
      {
        const std::lock_guard held(rig.serving->lock);
        EXPECT_EQ(rig.server.devices()[0].phase_steps(), nulls ? 1 : phase) << slot_s;
        EXPECT_EQ(rig.server.devices()[0].intensity_steps(), nulls ? 1 : intensity) << slot_s;
        EXPECT_EQ(rig.server.violation_count(), 0u);
      }
      const array::Changes model =
          array::changes_of(array::find_board_type("autd3"), {.slot_s = slot_s, .nulls = nulls});
      EXPECT_EQ(model.phase_steps, nulls ? 1 : phase) << "what --audible assumes";
      EXPECT_EQ(model.amplitude_steps, nulls ? 1 : intensity);
      board->all_off();
      EXPECT_TRUE(board->close());
    }
  }
}

TEST(Autd3Board, ADriveOfNothingSilencesAndSoDoesAPlanOfNothing) {
  Opened rig;
  rig.plan();
  ASSERT_TRUE(rig.sounds());
  rig.board->plan({{{1500, 1500}, monotonic_s(), 1.5e-3}});
  EXPECT_TRUE(rig.falls_silent());
  rig.plan();
  ASSERT_TRUE(rig.sounds());
  const std::uint64_t transitions = rig.device().transitions();
  rig.slot = 2004;
  rig.board->play(rig.slot + 1, rig.silence);
  EXPECT_TRUE(rig.tend_until([&] { return rig.device().transitions() > transitions && rig.silent(); }));
  // It returns with the next drive that sounds: after SIGCONT, nobody sends the plan again.
  rig.board->play(rig.slot + 2, rig.part(rig.slot + 2));
  EXPECT_TRUE(rig.sounds());
  rig.board->all_off();
  EXPECT_TRUE(rig.falls_silent());
  rig.tend_for(30ms);
  rig.end_silent();
}

TEST(Autd3Board, AllOffLeavesNothingInEitherMemory) {
  for (const bool foci_as_drives : {false, true}) {
    Rig rig("paper");
    rig.open();
    if (foci_as_drives) {
      rig.board->play(1, rig.part(1));
    } else {
      rig.plan(200);
    }
    ASSERT_TRUE(rig.sounds());
    rig.end_silent();
    for (const EmulatedDevice& device : rig.server.devices())
      EXPECT_TRUE(device.empty()) << "a pattern is left that a transition would bring back";
  }
}

TEST(Autd3Board, DrivesWithoutAPlanComeOneByOneAndReplaceEachOther) {
  Opened rig;
  {
    const std::lock_guard hangs(rig.serving->lock);
    for (std::uint64_t s = 1; s < 30; ++s)
      rig.board->play(s, rig.part(s));
    EXPECT_EQ(rig.board->counts().submitted.drives, 1u) << "each waits for the one before";
    EXPECT_EQ(rig.board->counts().completed.drives, 0u);
  }
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0) == 9; }));
  EXPECT_TRUE(rig.tend_until([&] { return rig.board->counts().completed.drives == 2; })) << "the first and the newest";
  EXPECT_EQ(rig.board->counts().submitted.drives, 2u);
  rig.board->play(30, rig.silence);
  EXPECT_TRUE(rig.falls_silent());
  rig.end_silent();
  ASSERT_EQ(rig.notes.infos.size(), 1u);
  EXPECT_CONTAINS(rig.notes.infos[0], "2 of 29 drives transferred");
}

TEST(Autd3Board, CountsDrivesOnceTheirPlanHasCome) {
  Opened rig;
  const auto counts = [&] { return rig.board->counts(); };
  const auto play = [&](int drives) {
    for (int i = 0; i < drives; ++i, ++rig.slot)
      rig.board->play(rig.slot, rig.part(rig.slot));
  };
  {
    // A server that hangs: the data that may wait until a plan arrives is bounded, and later data is lost.
    const std::lock_guard hangs(rig.serving->lock);
    rig.plan();
    play(10);
    EXPECT_EQ(counts().starting, 10u);
    play(20);
    EXPECT_EQ(counts().starting, 18u) << "13 messages of 2 ms";
    EXPECT_EQ(counts().completed.drives, 0u);
  }
  ASSERT_TRUE(rig.tend_until([&] { return counts().completed.plans == 1; }));
  EXPECT_EQ(counts().submitted.plans, 1u);
  play(40);
  EXPECT_EQ(counts().completed.drives, 40u);
  EXPECT_EQ(counts().submitted.drives, 40u);
  EXPECT_EQ(counts().starting, 18u);
  rig.end_silent();
}

TEST(PlanTally, EachTouchMayBeginBeforeItsPlan) {
  PlanTally tally;
  for (const std::uint64_t touch : {1, 2, 3}) {
    tally.allow(2);
    for (int drive = 0; drive < 5; ++drive)
      tally.play();
    EXPECT_EQ(tally.counts(false).starting, 2 * touch);
    tally.sent();
    tally.there();
    tally.play();
    EXPECT_EQ(tally.counts(false).completed.drives, touch);
    tally.gone();
  }
}

/// Whether the first device's intensity goes from nothing to all within a period of 200 Hz.
bool is_modulated(const Rig& rig) {
  std::uint8_t least = 255, most = 0;
  for (int i = 0; i < 20; ++i) {
    const auto heard = rig.device().output((i + 0.5) / 4000)[0].intensity;
    least = std::min(least, heard);
    most = std::max(most, heard);
  }
  return least < 5 && most > 250;
}

TEST(Autd3Board, FullAmplitudesTakeHalfTheMessagesAndAModulationOneMore) {
  Opened rig;
  const std::uint64_t before = rig.device().operations();
  for (auto& drive : rig.drives)
    drive.amplitude = 1;
  rig.plan(200);
  ASSERT_TRUE(rig.tend_until([&] { return rig.device().transitions() == 2; }));
  EXPECT_EQ(rig.device().operations() - before, 1u + 5 + 1);  // modulation, pairs, transition
  EXPECT_TRUE(is_modulated(rig));
  rig.end_silent();
}

TEST(Autd3Board, FociOneByOneAtFullAmplitudeAreOneMessage) {
  Rig rig("paper");
  rig.layout = array::transformed(rig.layout, glm::rotate(Transform(1.0), 0.3, Vec3(1, 2, 3)));
  rig.open();
  for (int p = 0; p < 10; ++p)
    aim(rig, {0.01 * std::cos(p), 0.01 * std::sin(p), 0.002 * p});
  const std::uint64_t before = rig.device().operations();
  const double planned_s = rig.plan();
  ASSERT_TRUE(rig.sounds());
  EXPECT_EQ(rig.device().operations() - before, 2u) << "the foci, the transition";
  {
    const std::lock_guard held(rig.serving->lock);
    int right = 0;
    for (int s = 0; s < 20; ++s) {
      int best = 1000;
      for (const double off_s : {-0.75e-3, 0.7e-3}) {
        int worst = 0;
        for (std::size_t d = 0; d < 16; ++d) {
          const auto heard = rig.server.devices()[d].output(planned_s + (100 + s + 0.5) * 1.5e-3 + off_s);
          for (std::size_t t = 0; t < transducers; ++t) {
            const int apart =
                (heard[t].phase - emission(rig.part(rig.slot + 100 + s)[d * transducers + t]).phase) & 255;
            worst = std::max(worst, std::min(apart, 256 - apart));
          }
        }
        best = std::min(best, worst);
      }
      right += best <= 3 ? 1 : 0;  // 0.025 mm are 0.75 steps; tables and rounding add the rest
    }
    EXPECT_EQ(right, 20);
  }
  // Anything that is not a focus, or not at full amplitude, is sent as drives.
  rig.drives[5].amplitude = 0.5f;
  const std::uint64_t transitions = rig.device().transitions();
  rig.plan();
  EXPECT_TRUE(rig.tend_until([&] { return rig.device().transitions() > transitions; }));
  EXPECT_EQ(rig.device().operations() - before, 2u + 10 + 1);
  rig.end_silent();
}

TEST(Autd3Board, FociOneByOneHaveAnIntensityEach) {
  Opened rig;
  for (int p = 0; p < 10; ++p)
    aim(rig, {0.01 * std::cos(p), 0.01 * std::sin(p), 0.1});
  for (std::size_t t = 0; t < rig.drives.size(); ++t)
    rig.drives[t].amplitude = 0.1f * static_cast<float>(t / transducers);  // 0 is a pause of the pattern
  const std::uint64_t before = rig.device().operations();
  const double planned_s = rig.plan();
  ASSERT_TRUE(rig.tend_until([&] { return rig.device().transitions() == 2; }));
  EXPECT_EQ(rig.device().operations() - before, 2u) << "the foci, the transition";
  {
    const std::lock_guard held(rig.serving->lock);
    std::vector<int> heard, wanted;
    for (int s = 0; s < 10; ++s) {
      const auto output = rig.device().output(planned_s + (100 + s + 0.5) * 1.5e-3);
      for (const auto& one : output)
        EXPECT_EQ(one.intensity, output[0].intensity);
      heard.push_back(output[0].intensity);
      wanted.push_back(emission(rig.part(static_cast<std::uint64_t>(s))[0]).intensity);
    }
    std::ranges::sort(heard);
    std::ranges::sort(wanted);
    EXPECT_EQ(heard, wanted);
  }
  rig.end_silent();
}

TEST(Autd3Board, FociInSoundOfASpeedThatADeviceCannotBeToldAreDrives) {
  struct Sound {
    double speed_m_s, way_m;
    bool told;
  };
  for (const Sound& sound : {Sound{1000, 0.1, true}, Sound{1100, 0.1, false}, Sound{100.0078, 3, false}}) {
    Rig rig;
    rig.sound_speed_m_s = sound.speed_m_s;
    rig.open();
    for (int p = 0; p < 10; ++p)
      aim(rig, {0.01 * p, 0, sound.way_m});
    const std::uint64_t before = rig.device().operations();
    rig.plan();
    ASSERT_TRUE(rig.sounds());
    const std::uint64_t one = 1 + 1, pairs = 5 + 1;  // plus the transition
    EXPECT_EQ(rig.device().operations() - before, sound.told ? one : pairs) << sound.speed_m_s;
    rig.end_silent();
  }
}

TEST(Autd3Board, RefusesWhatItCannotPlay) {
  Rig rig, two("paper"), other("openmpd"), old;
  EXPECT_ERROR(rig.make(0.1e-3 / 3), Exit::usage, "whole number of periods");
  two.argument = rig.argument;
  EXPECT_ERROR(two.make(), Exit::failed, "refuses: a geometry of 16 devices, but there are 1");
  rig.argument = "nowhere";
  EXPECT_ERROR(rig.make(), Exit::usage, "HOST:PORT");
  rig.argument = "127.0.0.1:1";
  EXPECT_ERROR(rig.make(), Exit::failed, "127.0.0.1:1 cannot be reached: Connection refused");
  EXPECT_REFUSED(other.make(), "AUTD3 units only");
  old.serving.reset();
  old.server = EmulatedServer(1, 0xa3);
  old.serving = std::make_unique<Serving>(old.server);
  old.argument = old.serving->address();
  EXPECT_ERROR(old.make(), Exit::failed, "device 0 has firmware 0xa3");
}

TEST(Autd3Board, AllAddressesOfANameAreTried) {
  const Rig rig;
  Address address = resolve(rig.argument);
  const Address nobody = resolve("127.0.0.1:1");
  address.places.insert(address.places.begin(), nobody.places.front());
  Remote remote(address, rig.layout);
  remote.connect(monotonic_s());
  test::begins([&] {
    remote.pump(monotonic_s());
    return remote.idle() || remote.closed();
  });
  EXPECT_TRUE(remote.idle()) << remote.fault();
}

TEST(Autd3Board, AServerThatComesBackIsSilencedBeforeItSounds) {
  Opened rig;
  rig.plan();
  ASSERT_TRUE(rig.sounds());
  const std::uint16_t port = rig.serving->port();
  rig.serving.reset();  // the devices continue to sound
  EXPECT_FALSE(rig.silent());
  for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(1ms)) {
    ++rig.slot;
    rig.board->play(rig.slot, rig.part(rig.slot));
    rig.board->tend();
  }
  ASSERT_EQ(rig.notes.warnings.size(), 1u) << "told once";
  EXPECT_TRUE(rig.board->counts().out_of_reach);
  rig.serving = std::make_unique<Serving>(rig.server, port);
  ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 2; }));
  EXPECT_CONTAINS(rig.notes.warnings[1], "the server is back");
  EXPECT_FALSE(rig.board->counts().out_of_reach);
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0) >= 0; }));
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
  EXPECT_TRUE(rig.silent());
}

TEST(Autd3Board, AServerThatComesBackIsModulatedAgain) {
  Opened rig;
  for (auto& drive : rig.drives)
    drive.amplitude = 1;
  rig.plan(200);
  ASSERT_TRUE(rig.sounds());
  const std::uint16_t port = rig.serving->port();
  rig.serving.reset();
  ASSERT_TRUE(test::begins([&] {
    rig.board->tend();
    return rig.notes.warnings.size() == 1;
  }));
  rig.serving = std::make_unique<Serving>(rig.server, port);
  ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 2; }));
  ASSERT_TRUE(rig.sounds());
  EXPECT_TRUE(is_modulated(rig)) << "the devices were cleared";
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
}

TEST(Autd3Board, ASlowServerHearsTheNewestPlanAndSilenceInTime) {
  Rig rig;
  rig.serving.reset();
  rig.serving = std::make_unique<Serving>(rig.server, 0, 3ms);
  rig.argument = rig.serving->address();
  rig.open();
  const double begin_s = monotonic_s();
  for (int i = 0; i < 40; ++i) {  // a frame every 4 ms; a plan takes 60 ms to arrive
    rig.drives[0].amplitude = static_cast<float>(i) / 100;
    rig.plan();
    rig.tend_for(4ms);
  }
  EXPECT_LT(rig.device().transitions(), 5 + (monotonic_s() - begin_s) / 60e-3);
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0.5 * 1.5e-3) >= 0; })) << "the last of them";
  const std::uint64_t operations = rig.device().operations();
  rig.plan();
  rig.board->play(rig.slot, rig.silence);
  EXPECT_TRUE(rig.falls_silent());
  EXPECT_LE(rig.device().operations() - operations, 2u) << "silence waits for one message at most";
  EXPECT_TRUE(rig.board->close());
  EXPECT_TRUE(rig.notes.warnings.empty());
  EXPECT_EQ(rig.server.violation_count(), 0u);
}

/// A server that answers once, with anything.
class Stranger {
 public:
  explicit Stranger(std::string answer, bool stays)
      : answer_(std::move(answer)), stays_(stays), socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
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

/// A server of real units answers the geometry when their bus is open.
TEST(Autd3Board, WaitsForTheServerToOpenItsBusAndSaysSo) {
  constexpr std::uint8_t geometry = 0x01;
  driver::autd3::EmulatedServer server(1);
  std::atomic<bool> open{false};
  const test::Autd3Serving serving(server, 0, [&](std::span<const std::uint8_t> bytes) {
    while (bytes[0] == geometry && !open)
      std::this_thread::sleep_for(1ms);
  });
  struct Opens final : test::KeptNotes {
    explicit Opens(std::atomic<bool>& bus) : open(&bus) {}
    void waits(std::string_view line) noexcept override {
      test::KeptNotes::waits(line);
      *open = true;
    }
    std::atomic<bool>* open;
  } notes(open);
  const auto board = board_kind().open({.argument = serving.address(), .layout = array::load_layout("autd3")}, notes);
  EXPECT_EQ(notes.waits_for, (std::vector<std::string>{"waiting up to 30 s until the server has opened its bus"}));
  EXPECT_TRUE(board->close());
}

TEST(Autd3Board, AServerThatLiesOrIsSilentIsGivenUp) {
  const auto expect = [](const std::string& answer, bool stays, const char* part, const char* layout = "autd3") {
    Rig rig(layout);
    const Stranger stranger(answer, stays);
    rig.argument = stranger.address();
    EXPECT_ERROR(rig.make(), Exit::failed, part);
  };
  expect("HTTP/1.1 400", true, "does not speak AUTD3's Remote protocol");
  expect("", true, "does not answer");
  expect("", false, "closed the connection");
  expect(std::string("\xff\xff\xff\xff\xff", 5) + std::string(1000, 'x'), true, "refuses: xxx");
  expect(std::string("\xff\x10\0\0\0too short", 14), false, "closed the connection");
  expect(std::string("ARMT\x07\x05") + "0.9.0", true, "is a server or simulator of autd3-sdk");
  // Hello, geometry and a message are answered well. Instead of the devices' answers, there is a refusal without a
  // text, and a lot of unrequested data.
  expect(std::string("\0\0\0\xff\0\0\0\0", 8) + std::string(4000, 'x'), true, "refuses", "paper");
}

}  // namespace
}  // namespace palpa::driver::autd3
