// AUTD3, UDP line: the board with made-up units, in a time that passes only while somebody waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "base/error.hpp"
#include "chain_rig.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::autd3_udp {
namespace {

using test::Bytes;
using test::ChainRig;
using test::MadeUpUnit;

constexpr int protocols_there[] = {2, 3, 5};

bool has_time(const Bytes& frame) {
  return frame[0] != 2 && (frame[6] | frame[7] | frame[8] | frame[9]) != 0;
}

TEST(Autd3UdpBoard, OpensAChainAndItsUnitsAreClearedBeforeTheyHaveTheTime) {
  for (const int protocol : protocols_there) {
    for (const std::size_t count : {1u, 3u}) {
      ChainRig rig(protocol, count);
      std::vector<bool> locked_at_clear;
      for (MadeUpUnit& unit : rig.chain.units) {  // of a program that died
        unit.id = static_cast<int>(&unit - rig.chain.units.data());
        unit.far_open = true;
        unit.banks[0][0] = MadeUpUnit::Pattern(249, {1, 200});
      }
      rig.chain.on_frame = [&](const Bytes& frame, int unit) {
        if (frame[5] == 0x03) locked_at_clear.push_back(rig.chain.units[static_cast<std::size_t>(unit)].locked);
      };
      rig.open();
      EXPECT_EQ(rig.sounding(), 0u);
      EXPECT_EQ(rig.chain.strangers, 0u);
      ASSERT_EQ(locked_at_clear.size(), 2 * count);
      EXPECT_EQ(std::ranges::count(locked_at_clear, false), static_cast<long>(count)) << "once at once, and once more";
      std::vector<int> expected = {0xeb, 0x03, 0x03, 0x01, 0x30};
      if (protocol == 5) expected = {0xeb, 0x03, 0x05, 0x03, 0x05, 0x01, 0x30};
      for (std::size_t u = 0; u < count; ++u) {
        const MadeUpUnit& unit = rig.chain.units[u];
        EXPECT_EQ(unit.id, static_cast<int>(u));
        EXPECT_EQ(unit.first, u == 0);
        EXPECT_EQ(unit.commands, expected) << protocol;
        EXPECT_EQ(unit.failsafe_ms, 500);
        EXPECT_EQ(unit.frames[0][5], protocol == 5 ? 0xeb : 0) << "it begins with Reset, where there is one";
      }
      EXPECT_TRUE(rig.notes.warnings.empty());
    }
  }
}

TEST(Autd3UdpBoard, WhatCannotBeDrivenIsOneLineWithWhatWasSeen) {
  const auto line = [](ChainRig& rig) { return test::error_of([&] { rig.open(); }, Exit::failed); };
  {
    ChainRig rig(5, 2);
    for (MadeUpUnit& unit : rig.chain.units)
      unit.protocol = 4;
    EXPECT_CONTAINS(line(rig), "the units speak protocol 4, and palpa knows 2 (firmware 0.10 and 0.11), 3");
    EXPECT_EQ(rig.chain.to_units, 0u);
  }
  for (const bool far_open : {true, false}) {
    ChainRig rig(5, 2);
    rig.chain.units[0].far_open = far_open;
    rig.chain.units[1].protocol = 3;
    EXPECT_CONTAINS(line(rig), "different protocols, ");
    for (const MadeUpUnit& unit : rig.chain.units)
      EXPECT_LE(std::ranges::count(unit.commands, 0x16), 0);
    EXPECT_TRUE(!far_open || rig.chain.to_units == 0);
  }
  {
    ChainRig rig(3, 1);
    rig.chain.units[0].minor = 13;
    EXPECT_CONTAINS(line(rig), "unit 0 has firmware 0.13.0 (its FPGA 0.13.0); with protocol 3 palpa needs 0.12");
    EXPECT_EQ(rig.chain.units[0].commands, std::vector<int>{0xeb});
  }
  for (const auto& [there, wanted, text] : {std::tuple(1u, 2u, "1 unit answers, and the layout chain has 2"),
                                            {3u, 2u, "3 units answer, and the layout chain has 2"}}) {
    ChainRig rig(5, there);
    ChainRig other(5, wanted);
    rig.layout = other.layout;
    EXPECT_CONTAINS(line(rig), text);
  }
  {
    ChainRig rig(5, 1);
    rig.chain.units[0].mute = true;
    EXPECT_CONTAINS(line(rig), "no AUTD3 unit answers at [ff02::1");
  }
}

TEST(Autd3UdpBoard, DrivesSoundOnAllUnitsAtTheSameMoment) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 3);
    rig.open();
    for (int n = 1; n <= 40; ++n) {
      rig.play(n);
      rig.next_slot();
    }
    rig.pass(0.01);
    for (const MadeUpUnit& unit : rig.chain.units) {
      ASSERT_EQ(unit.shown.size(), 40u) << protocol;
      for (std::size_t n = 0; n < 40; ++n) {
        EXPECT_EQ(unit.shown[n], MadeUpUnit::Pattern(249, {static_cast<int>(n + 1), 255}));
        if (protocol == 2) continue;
        EXPECT_EQ(unit.shown_s[n], rig.chain.units[0].shown_s[n]);
        if (n > 0) {
          EXPECT_NEAR(unit.shown_s[n] - unit.shown_s[n - 1], rig.slot_s, 0.6e-3);
        }
      }
      if (protocol == 2) continue;
      const auto of_drives = [](const Bytes& frame) { return frame[5] == 0x16; };
      for (const Bytes& frame : unit.frames)
        EXPECT_EQ(has_time(frame), of_drives(frame));
    }
    EXPECT_EQ(rig.board->counts().completed.drives, 40u);
    rig.board->all_off();
    EXPECT_TRUE(rig.board->close());
    EXPECT_EQ(rig.sounding(), 0u);
    EXPECT_TRUE(rig.notes.warnings.empty());
    ASSERT_EQ(rig.notes.infos.size(), 1u);
    EXPECT_CONTAINS(rig.notes.infos[0], "40 of 40 drives carried out by all units");
  }
}

TEST(Autd3UdpBoard, SilenceIsRepeatedPastLossesAFullQueueAndFramesThatWait) {
  for (const int protocol : protocols_there) {
    for (const int fault : {0, 1, 2}) {
      ChainRig rig(protocol, 2);
      rig.open();
      for (int n = 1; n <= 5; ++n) {
        rig.play(n);
        if (n < 5) rig.next_slot();
      }
      MadeUpUnit& unit = rig.chain.units[1];
      if (fault == 0) unit.lose = 3;
      if (fault == 1) unit.lose_answers = 3;
      if (fault == 2) unit.queue_full = 3;
      rig.board->play(++rig.slot, rig.silence);
      EXPECT_TRUE(rig.silent_within(0.06)) << protocol << " " << fault;
      rig.board->all_off();
      EXPECT_TRUE(rig.board->close());
      for (MadeUpUnit& one : rig.chain.units) {
        for (int bank : {0, 1}) {  // nothing waits there that could sound
          one.bank = bank;
          EXPECT_FALSE(one.sounds()) << protocol << " " << fault;
        }
      }
      EXPECT_TRUE(rig.notes.warnings.empty());
    }
  }
}

/// What a unit sounds goes forward from drive to drive, and never back to one that another has replaced.
TEST(Autd3UdpBoard, LossesAndRepeatsBringNoWrongPattern) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 2);
    rig.open();
    std::uint32_t seed = 7;
    const auto chance = [&] { return (seed = seed * 1664525 + 1013904223) >> 28 == 0; };
    for (int n = 1; n <= 240; ++n) {
      MadeUpUnit& unit = rig.chain.units[static_cast<std::size_t>(n % 2)];
      if (chance()) unit.lose = 1;
      if (chance()) unit.lose_answers = 1;
      if (chance()) unit.repeat = 1;
      rig.play(n);
      rig.next_slot();
    }
    rig.pass(0.05);
    for (const MadeUpUnit& unit : rig.chain.units) {
      for (std::size_t i = 1; i < unit.shown.size(); ++i)
        EXPECT_GE(unit.shown[i][0].first, unit.shown[i - 1][0].first) << protocol;
      EXPECT_EQ(unit.shown.back()[0].first, 240) << protocol;
    }
    EXPECT_TRUE(rig.notes.warnings.empty());
    EXPECT_GT(rig.board->counts().completed.drives, 150u);
    rig.board->all_off();
    EXPECT_TRUE(rig.board->close());
  }
}

constexpr auto full = [](std::size_t, std::size_t) { return 1.0f; };
constexpr auto mixed = [](std::size_t part, std::size_t t) { return (part + t) % 2 == 0 ? 1.0f : 0.5f; };

/// Short slots: units play by their own clock. They have the drives of all slots, and begin at the same moment with the
/// part that the loop's slots have reached.
TEST(Autd3UdpBoard, APlanOfShortSlotsIsWrittenAheadAndSoundsAsAWhole) {
  const std::vector<Vec3> foci = [] {
    std::vector<Vec3> out;
    for (int i = 0; i < 10; ++i)
      out.emplace_back(0.001 * i, 0, 0.1);
    return out;
  }();
  for (const int protocol : protocols_there) {
    for (const int command : {0x15, 0x13, 0x10}) {
      for (const bool loses : {false, true}) {
        ChainRig rig(protocol, 2);
        rig.slot_s = 0.1e-3;
        rig.open();
        for (MadeUpUnit& unit : rig.chain.units)
          unit.commands.clear();
        if (loses) rig.chain.units[1].lose = rig.chain.units[0].lose_answers = 1;
        rig.slot = 12345;
        const double begin_s = rig.clock.now_s();
        if (command == 0x15) rig.plan(10, mixed);
        if (command == 0x13) rig.plan(10, full);
        if (command == 0x10) rig.plan(10, full, 0, foci);
        rig.pass(0.1);
        for (MadeUpUnit& unit : rig.chain.units) {
          EXPECT_EQ(std::ranges::count(unit.commands, command) > 0, true) << protocol << " " << command;
          EXPECT_EQ(std::ranges::count(unit.commands, 0x12) > 0, true);
          EXPECT_TRUE(unit.sounds());
          EXPECT_EQ(unit.size[unit.bank], 10);
          EXPECT_EQ(unit.divider[unit.bank], 4);
          EXPECT_EQ(unit.foci[unit.bank], command == 0x10);
          for (int slot = 0; slot < 10; ++slot) {  // in its middle, which half a slot does not move out of
            const double at_s = begin_s + 0.1e-3 * (slot + 0.5) - rig.chain.set_s;
            const auto index = static_cast<std::uint64_t>(at_s / 0.1e-3) % 10;
            const int expected = static_cast<int>((rig.slot + static_cast<std::uint64_t>(slot)) % 10);
            const auto& [phase, intensity] = unit.banks[unit.bank][static_cast<int>(index)].at(0);
            if (command == 0x10) {
              EXPECT_EQ(intensity, 255);
            } else {
              const int off = std::min((phase - expected + 10) % 10, (expected - phase + 10) % 10);
              EXPECT_LE(off, 1) << protocol << " " << slot;
            }
          }
          if (protocol != 2 && !loses) {
            EXPECT_EQ(unit.shown_s.back(), rig.chain.units[0].shown_s.back());
          }
        }
        for (int i = 0; i < 100; ++i) {
          rig.board->play(rig.slot++, std::span(rig.drives).first(rig.silence.size()));
        }
        const BoardCounts counts = rig.board->counts();
        EXPECT_EQ(counts.completed.plans, 1u);
        EXPECT_EQ(counts.completed.drives, 100u);
        rig.board->all_off();
        EXPECT_TRUE(rig.board->close());
        for (MadeUpUnit& unit : rig.chain.units) {
          EXPECT_FALSE(unit.sounds());
          unit.bank ^= 1;
          EXPECT_FALSE(unit.sounds()) << "nor the other bank";
        }
        EXPECT_TRUE(rig.notes.warnings.empty());
      }
    }
  }
}

TEST(Autd3UdpBoard, ASilenceWhileAPlanIsWrittenEndsIt) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 2);
    rig.slot_s = 0.1e-3;
    rig.open();
    rig.plan(40, mixed);
    rig.pass(0.5e-3);
    rig.board->all_off();
    rig.pass(0.1);
    for (MadeUpUnit& unit : rig.chain.units) {
      EXPECT_TRUE(std::ranges::none_of(unit.shown, [](const auto& pattern) {
        return std::ranges::any_of(pattern, [](const auto& one) { return one.second > 0; });
      })) << protocol;
      for (int bank : {0, 1}) {
        unit.bank = bank;
        EXPECT_FALSE(unit.sounds()) << protocol;
      }
    }
    EXPECT_TRUE(rig.board->close());
  }
}

TEST(Autd3UdpBoard, APlanOfLongSlotsIsSentDriveByDrive) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 2);
    rig.open();
    rig.plan(10, mixed);
    for (int i = 0; i < 30; ++i) {
      rig.board->play(rig.slot, std::span(rig.drives).first(rig.silence.size()));
      rig.next_slot();
    }
    rig.pass(0.01);
    for (const MadeUpUnit& unit : rig.chain.units) {
      ASSERT_EQ(unit.shown.size(), 30u) << protocol;
      for (int i = 0; i < 30; ++i)
        EXPECT_EQ(unit.shown[static_cast<std::size_t>(i)][0].first, i % 10);
    }
    EXPECT_EQ(rig.board->counts().completed.drives, 30u);
  }
}

/// A guard passes no silent drive of a pattern on, so units make such a pause by their own clock.
TEST(Autd3UdpBoard, APlanWithPausesIsWrittenAheadAlsoIfItsSlotsAreLong) {
  ChainRig rig(5, 1);
  rig.open();
  rig.plan(4, [](std::size_t part, std::size_t t) { return part == 2 ? 0.0f : mixed(part, t); });
  rig.pass(0.05);
  MadeUpUnit& unit = rig.chain.units[0];
  EXPECT_EQ(std::ranges::count(unit.commands, 0x12), 1);
  EXPECT_EQ(unit.size[unit.bank], 4);
  int silent = 0;
  for (int part = 0; part < 4; ++part)
    silent += std::ranges::all_of(unit.banks[unit.bank][part], [](const auto& one) { return one.second == 0; }) ? 1 : 0;
  EXPECT_EQ(silent, 1);
}

TEST(Autd3UdpBoard, AModulationIsPlayedFromTheUnitsMemory) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 2);
    rig.open();
    rig.plan(1, mixed, 200);
    rig.pass(0.05);
    for (const MadeUpUnit& unit : rig.chain.units) {
      const Bytes& samples = unit.modulation[unit.modulation_bank];
      EXPECT_EQ(unit.modulation_divider[unit.modulation_bank], 10);
      ASSERT_EQ(samples.size(), 20u) << "200 Hz at 4 kHz";
      double sine = 0, cosine = 0, mean = 0;
      for (std::size_t i = 0; i < 20; ++i) {
        sine += samples[i] * std::sin(2 * M_PI * static_cast<double>(i) / 20) / 10;
        cosine += samples[i] * std::cos(2 * M_PI * static_cast<double>(i) / 20) / 10;
        mean += samples[i] / 20.0;
      }
      EXPECT_NEAR(mean, 127.5, 1);
      EXPECT_NEAR(std::hypot(sine, cosine), 127.5, 1);
      EXPECT_EQ(unit.shown.size(), 1u);
    }
    rig.plan(1, full);
    rig.pass(0.05);
    for (const MadeUpUnit& unit : rig.chain.units) {
      EXPECT_EQ(unit.modulation[unit.modulation_bank], (Bytes{255, 255}));
      EXPECT_EQ(unit.shown.size(), 2u);
    }
  }
}

TEST(Autd3UdpBoard, UnitsThatArePlayedNothingKeepHearingPalpa) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 2);
    rig.open();
    rig.pass(3);
    for (const MadeUpUnit& unit : rig.chain.units)
      EXPECT_FALSE(unit.shut);
    EXPECT_TRUE(rig.notes.warnings.empty());
  }
}

TEST(Autd3UdpBoard, AUnitThatIsLostSilencesTheOthersAndItsReturnIsTold) {
  for (const int protocol : protocols_there) {
    for (const bool reboots : {false, true}) {
      ChainRig rig(protocol, 3);
      rig.open();
      const auto play_for = [&](double seconds) {
        for (const double end_s = rig.clock.now_s() + seconds; rig.clock.now_s() < end_s; rig.next_slot())
          rig.play(static_cast<int>(rig.slot % 200));
      };
      play_for(0.1);
      EXPECT_EQ(rig.sounding(), 3u);
      if (reboots) {
        rig.chain.reboot(1);
      } else {
        rig.chain.units[1].mute = true;
      }
      play_for(0.52);
      EXPECT_EQ(rig.sounding(), 0u) << protocol << " " << reboots;
      ASSERT_EQ(rig.notes.warnings.size(), 1u);
      EXPECT_CONTAINS(rig.notes.warnings[0], "does not answer any more");
      EXPECT_TRUE(rig.board->counts().out_of_reach);
      rig.chain.units[1].mute = false;
      play_for(5);
      EXPECT_EQ(rig.sounding(), 3u) << protocol << " " << reboots;
      ASSERT_EQ(rig.notes.warnings.size(), 2u) << rig.notes.warnings.back();
      EXPECT_CONTAINS(rig.notes.warnings[1], "the units are back");
      EXPECT_FALSE(rig.board->counts().out_of_reach);
      rig.board->all_off();
      EXPECT_TRUE(rig.board->close());
      EXPECT_EQ(rig.sounding(), 0u);
    }
  }
}

TEST(Autd3UdpBoard, AFailsafeThatShutAndALostPulseAreFaults) {
  for (const auto& [protocol, pulse, text] : {std::tuple(5, false, "its failsafe has shut"),
                                              {5, true, "has lost its pulse"},
                                              {3, true, "has lost its pulse"}}) {
    ChainRig rig(protocol, 2);
    rig.open();
    rig.play(1);
    rig.pass(0.02);
    EXPECT_EQ(rig.sounding(), 2u);
    (pulse ? rig.chain.units[1].pulse : rig.chain.units[1].shut) = !pulse;
    rig.pass(0.1);
    EXPECT_EQ(rig.sounding(), 0u);
    ASSERT_EQ(rig.notes.warnings.size(), 1u);
    EXPECT_CONTAINS(rig.notes.warnings[0], text);
  }
  for (const int protocol : {2, 3}) {  // this machine stood still, and they say it only if they are asked
    ChainRig rig(protocol, 2);
    rig.open();
    rig.clock.sleep_s(0.6);
    rig.board->tend();
    rig.pass(0.05);
    ASSERT_EQ(rig.notes.warnings.size(), 1u);
    EXPECT_CONTAINS(rig.notes.warnings[0], "its failsafe has shut");
  }
}

TEST(Autd3UdpBoard, AnswersThatLieAreLeftOut) {
  for (const int protocol : protocols_there) {
    ChainRig rig(protocol, 2);
    rig.open();
    std::uint32_t seed = 3;
    const auto random = [&] { return (seed = seed * 1664525 + 1013904223) >> 20; };
    for (int n = 1; n <= 200; ++n) {
      rig.play(n);
      for (int lie = 0; lie < 20; ++lie) {
        Bytes bytes(random() % 40);
        for (std::uint8_t& byte : bytes)
          byte = static_cast<std::uint8_t>(random());
        if (bytes.size() > 3 && lie % 2 == 0) {
          bytes[0] = static_cast<std::uint8_t>(protocol);
          bytes[1] &= 7;
        }
        driver::autd3_udp::Endpoint from = test::unit_address(static_cast<int>(random() % 256));
        if (lie % 3 == 0) from.scope = 8;
        if (lie % 3 == 1) from.address[0] = 0x20;
        if (lie % 3 == 2) from.port = 1234;
        rig.chain.answers.push_front({bytes, from});
      }
      rig.next_slot();
    }
    rig.pass(0.02);
    EXPECT_EQ(rig.chain.strangers, 0u);
    EXPECT_TRUE(rig.notes.warnings.empty());
    EXPECT_EQ(rig.board->counts().completed.drives, 200u);
  }
}

TEST(Autd3UdpCable, TheGroupIsAnInterfaceOrAnAddressWithAPort) {
  EXPECT_EQ(to_text(parse_group("lo")), "[ff02::1%lo]:44336");
  EXPECT_EQ(to_text(parse_group("[::1%lo]:4000")), "[::1]:4000");
  EXPECT_EQ(to_text(parse_group("[ff02::1%lo]:44336")), "[ff02::1%lo]:44336");
  for (const char* text :
       {"no-such-nic", "[::1]", "[::1]:", "[::1]:0", "[::1]:70000", "[1.2.3.4]:5", "::1:5", "[::1%nowhere]:5"})
    EXPECT_CONTAINS(test::error_of([&] { parse_group(text); }, Exit::usage),
                    "neither a network interface of this computer nor [ADDRESS%SCOPE]:PORT");
  EXPECT_CONTAINS(test::error_of([&] { parse_group("[fe80::1]:5"); }, Exit::usage),
                  "needs its network interface: [fe80::1%INTERFACE]:5");
}

}  // namespace
}  // namespace palpa::driver::autd3_udp
