// AUTD3: the board with emulated units, in a time that passes only while somebody waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "autd3_rig.hpp"
#include "driver/autd3/board.hpp"
#include "driver/autd3/emulated/server.hpp"
#include "driver/autd3/remote.hpp"
#include "driver/autd3/wire.hpp"
#include "driver/plan_tally.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::autd3 {
namespace {

using test::part_heard;
using Rig = test::Autd3Rig;
using Opened = test::Opened<Rig>;

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
    for (int s = 0; s < 25; ++s) {
      // The two clocks are rounded to whole slots: the middle of a slot is within half a slot of the same part.
      const double middle_s = planned_s + (100 + s + 0.5) * 1.5e-3;
      const int before = part_heard(rig, middle_s - 0.75e-3), after = part_heard(rig, middle_s + 0.7e-3);
      const int expected = static_cast<int>((rig.slot + 100 + s) % 10);
      EXPECT_TRUE(before == expected || after == expected)
          << name << ": " << before << " or " << after << ", not " << expected;
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
      EXPECT_EQ(rig.device().phase_steps(), nulls ? 1 : phase) << slot_s;
      EXPECT_EQ(rig.device().intensity_steps(), nulls ? 1 : intensity) << slot_s;
      EXPECT_EQ(rig.server.violation_count(), 0u);
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
  rig.board->plan({{{1500, 1500}, rig.clock.now_s(), 1.5e-3}});
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
  rig.tend_for(0.03);
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
  rig.serving.hangs = true;
  for (std::uint64_t s = 1; s < 30; ++s)
    rig.board->play(s, rig.part(s));
  EXPECT_EQ(rig.board->counts().submitted.drives, 1u) << "each waits for the one before";
  EXPECT_EQ(rig.board->counts().completed.drives, 0u);
  rig.serving.hangs = false;
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
  // A server that hangs: the data that may wait until a plan arrives is bounded, and later data is lost.
  rig.serving.hangs = true;
  rig.plan();
  play(10);
  EXPECT_EQ(counts().starting, 10u);
  play(20);
  EXPECT_EQ(counts().starting, 18u) << "13 messages of 2 ms";
  EXPECT_EQ(counts().completed.drives, 0u);
  rig.serving.hangs = false;
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
  int right = 0;
  for (int s = 0; s < 20; ++s) {
    int best = 1000;
    for (const double off_s : {-0.75e-3, 0.7e-3}) {
      int worst = 0;
      for (std::size_t d = 0; d < 16; ++d) {
        const auto heard = rig.server.devices()[d].output(planned_s + (100 + s + 0.5) * 1.5e-3 + off_s);
        for (std::size_t t = 0; t < transducers; ++t) {
          const int apart = (heard[t].phase - emission(rig.part(rig.slot + 100 + s)[d * transducers + t]).phase) & 255;
          worst = std::max(worst, std::min(apart, 256 - apart));
        }
      }
      best = std::min(best, worst);
    }
    right += best <= 3 ? 1 : 0;  // 0.025 mm are 0.75 steps; tables and rounding add the rest
  }
  EXPECT_EQ(right, 20);
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
  two.server = EmulatedServer(1);
  EXPECT_ERROR(two.make(), Exit::failed, "refuses: a geometry of 16 devices, but there are 1");
  EXPECT_REFUSED(other.make(), "AUTD3 units only");
  old.server = EmulatedServer(1, 0xa3);
  EXPECT_ERROR(old.make(), Exit::failed, "device 0 has firmware 0xa3");
  rig.serving.end();
  EXPECT_ERROR(rig.make(), Exit::failed, "server:8080 cannot be reached: Connection refused");
  const auto link = [&](const char* argument) {
    return board_kind().open({.argument = argument, .layout = rig.layout}, rig.notes);
  };
  EXPECT_ERROR(link("nowhere"), Exit::usage, "HOST:PORT");
  EXPECT_ERROR(link("127.0.0.1:1"), Exit::failed, "127.0.0.1:1 cannot be reached: Connection refused");
}

/// Nothing goes on before each unit has acknowledged, and an error of each of them is reported.
TEST(Autd3Board, EachOfSeveralUnitsCounts) {
  for (const std::size_t one : {0u, 5u, 15u}) {
    Rig rig("paper");
    rig.board = rig.make(0.1e-3);
    std::uint64_t before = rig.device().operations();
    rig.serving.slow = one;
    rig.plan();
    rig.tend_for(0.1);
    EXPECT_EQ(rig.device().operations() - before, 1u) << "unit " << one << " has not acknowledged it";
    rig.serving.slow.reset();
    ASSERT_TRUE(rig.tend_until([&] { return part_heard(rig, rig.device_now_s()) >= 0; }));
    rig.tend_for(0.01);  // until the last message is acknowledged
    EXPECT_TRUE(rig.notes.warnings.empty());
    rig.server.devices()[one] = EmulatedDevice();  // it was without power, and does not take changes that fast
    rig.plan();
    ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 2; }));
    EXPECT_CONTAINS(rig.notes.warnings[0], "device " + std::to_string(one) + " refuses a message with error");
    EXPECT_CONTAINS(rig.notes.warnings[1], "the server is back");
    EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, rig.device_now_s()) >= 0; }));
  }
}

TEST(Autd3Board, AllAddressesOfANameAreTried) {
  Rig rig;
  Address address = rig.serving.address();
  const Address nobody = resolve("127.0.0.1:1");
  address.places.insert(address.places.begin(), nobody.places.front());
  Remote remote(address, rig.layout);
  remote.connect(rig.clock.now_s());
  rig.clock.passes_until([&] {
    remote.pump(rig.clock.now_s());
    return remote.idle() || remote.closed();
  });
  EXPECT_TRUE(remote.idle()) << remote.fault();
}

TEST(Autd3Board, AServerThatComesBackIsSilencedBeforeItSounds) {
  Opened rig;
  rig.plan();
  ASSERT_TRUE(rig.sounds());
  rig.serving.end();  // the devices continue to sound
  EXPECT_FALSE(rig.silent());
  for (int i = 0; i < 100; ++i, rig.clock.sleep_s(1e-3)) {
    ++rig.slot;
    rig.board->play(rig.slot, rig.part(rig.slot));
    rig.board->tend();
  }
  ASSERT_EQ(rig.notes.warnings.size(), 1u) << "told once";
  EXPECT_TRUE(rig.board->counts().out_of_reach);
  rig.serving.listen();
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
  rig.serving.end();
  ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 1; }));
  rig.serving.listen();
  ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 2; }));
  ASSERT_TRUE(rig.sounds());
  EXPECT_TRUE(is_modulated(rig)) << "the devices were cleared";
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
}

TEST(Autd3Board, ASlowServerHearsTheNewestPlanAndSilenceInTime) {
  Rig rig;
  rig.serving.late_s = 3e-3;
  rig.open();
  const double begin_s = rig.clock.now_s();
  for (int i = 0; i < 40; ++i) {  // a frame every 4 ms; a plan takes 60 ms to arrive
    rig.drives[0].amplitude = static_cast<float>(i) / 100;
    rig.plan();
    rig.tend_for(4e-3);
  }
  EXPECT_LT(rig.device().transitions(), 5 + (rig.clock.now_s() - begin_s) / 60e-3);
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

/// A server of real units answers the geometry when their bus is open.
TEST(Autd3Board, WaitsForTheServerToOpenItsBusAndSaysSo) {
  Rig rig;
  rig.serving.bus_closed = true;
  struct Opens final : test::KeptNotes {
    explicit Opens(bool& closed) : bus_closed(&closed) {}
    void waits(std::string_view line) noexcept override {
      test::KeptNotes::waits(line);
      *bus_closed = false;
    }
    bool* bus_closed;
  } notes(rig.serving.bus_closed);
  const auto board = open_board({.layout = rig.layout}, notes, rig.serving.address(), rig.clock);
  EXPECT_EQ(notes.waits_for, (std::vector<std::string>{"waiting up to 30 s until the server has opened its bus"}));
  EXPECT_TRUE(board->close());
}

TEST(Autd3Board, AServerThatLiesOrIsSilentIsGivenUp) {
  const auto expect = [](const std::string& answer, bool stays, const char* part, const char* layout = "autd3") {
    Rig rig(layout);
    rig.serving.lies = answer;
    rig.serving.stays = stays;
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
