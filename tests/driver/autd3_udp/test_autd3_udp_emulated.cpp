// The emulated units of AUTD3's UDP line: what they answer and sound. Recorded exchanges with the makers' own firmware,
// if they are there, and frames written by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "driver/autd3_udp/emulated/chain.hpp"
#include "support/shared_data.hpp"

namespace palpa::driver::autd3_udp {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(std::string_view text) {
  Bytes bytes;
  for (std::size_t at = 0; at + 1 < text.size(); at += 2) {
    unsigned value = 0;
    std::from_chars(text.data() + at, text.data() + at + 2, value, 16);
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  return bytes;
}

// ---- recordings -----------------------------------------------------------------------------------------------------

struct Line {
  double time_s = 0;
  bool down = false;
  int unit = -1;  ///< -1: the group
  Bytes bytes;
  std::uint16_t id() const { return static_cast<std::uint16_t>(bytes[2] | bytes[3] << 8); }
  bool answers(const Line& question) const {
    return !down && bytes[1] == question.bytes[1] && id() == question.id() &&
           (question.unit < 0 || unit == question.unit);
  }
};

std::vector<Line> read_step(const std::filesystem::path& file) {
  std::vector<Line> lines;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    std::istringstream words(text);
    double ms = 0;
    std::string way, who, hex;
    words >> ms >> way >> who >> hex;
    Bytes bytes = from_hex(hex);
    // The makers' emulator carries frames out at once, whatever moment they name.
    if (way == ">" && bytes[0] != 2 && bytes[1] == 0x00) std::fill_n(bytes.begin() + 6, 4, std::uint8_t{0});
    lines.push_back({1e-3 * ms, way == ">", who == "group" ? -1 : who.back() - '0', std::move(bytes)});
  }
  return lines;
}

/// What must be equal in two answers: all but the time, the clock's offset and whether the clocks are locked yet.
Bytes compared(Bytes answer) {
  const std::uint8_t protocol = answer[0], kind = answer[1];
  const bool frame = kind == 0x00 || kind == 0x07;
  const std::size_t flags = 6;
  if (frame && answer.size() >= 16) std::fill_n(answer.begin() + 8, 8, std::uint8_t{0});
  if (kind == 0x01 && answer.size() > 7) {
    std::fill(answer.begin() + (protocol == 5 ? 7 : 13), answer.end(), std::uint8_t{0});
    answer[flags] &= 0xe7;
    if (protocol != 5) answer[7] = 0;  // the upstream port
  }
  return answer;
}

class Recorded : public testing::TestWithParam<std::pair<std::string, std::size_t>> {};

TEST_P(Recorded, FramesGetTheRecordedAnswersAndSoundTheRecordedEmissions) {
  const auto& [release, units] = GetParam();
  PALPA_SHARED_OR_SKIP(folder, "autd3-udp");
  const std::string ending = "-" + std::to_string(units) + ".txt";
  std::map<std::uint16_t, std::pair<std::string, std::vector<Line>>> steps;  // by the first number, which runs on
  std::vector<Line> opening;
  for (const auto& entry : std::filesystem::directory_iterator(folder / release)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(ending)) continue;
    std::vector<Line> lines = read_step(entry.path());
    const std::string step = name.substr(0, name.size() - ending.size());
    if (step == "open") {
      opening = std::move(lines);
    } else {
      const std::uint16_t first = lines.front().id();
      steps[first] = {step, std::move(lines)};
    }
  }
  const std::uint8_t protocol = opening.front().bytes[0];
  EmulatedChain chain({.protocol = protocol, .units = units, .processing_s = 0, .lock_s = 0, .clock_ppm = 0});
  double now_s = 1;
  const auto play = [&](const std::string& step, const std::vector<Line>& lines) {
    const double begin_s = now_s;
    for (const Line& line : lines) {
      if (!line.down) continue;
      now_s = std::max(now_s + 2e-3, begin_s + line.time_s);
      const auto answered = [&](const Line& other) { return other.answers(line); };
      const auto wanted = std::count_if(lines.begin(), lines.end(), answered);
      const auto times = line.unit < 0 ? std::min<std::ptrdiff_t>(wanted, 1) : wanted;  // lost: 0, repeated: 2
      std::vector<EmulatedChain::Answer> answers;
      for (std::ptrdiff_t time = 0; time < times; ++time) {
        if (line.unit < 0) {
          chain.take_from_group(now_s, line.bytes);
        } else {
          chain.take(now_s, static_cast<std::size_t>(line.unit), line.bytes);
        }
        chain.advance(now_s + 1.5e-3);
        const auto came = chain.answers();
        answers.insert(answers.end(), came.begin(), came.end());
      }
      for (const Line& other : lines) {
        if (!answered(other)) continue;
        const auto same = std::find_if(answers.begin(), answers.end(), [&](const EmulatedChain::Answer& answer) {
          return static_cast<int>(answer.unit) == other.unit;
        });
        ASSERT_NE(same, answers.end()) << step << ": no answer to " << line.id() << " of unit " << other.unit;
        EXPECT_EQ(compared(same->bytes), compared(other.bytes)) << step << ": the answer to " << line.id();
        answers.erase(same);
      }
      EXPECT_TRUE(answers.empty()) << step << ": more answers to " << line.id();
    }
  };
  const auto heartbeat = [&] {
    now_s += 0.1;
    for (std::size_t unit = 0; unit < units; ++unit)
      chain.take(now_s, unit, Bytes{protocol, 0x07, 0, 0});
    chain.advance(now_s + 1e-3);
    chain.answers();
  };
  play("open", opening);
  std::size_t emissions = 0;
  for (const auto& [first, step] : steps) {
    const auto& [name, lines] = step;
    // Heartbeats are not in the files. Where the host was silent on purpose, it had spoken before.
    heartbeat();
    if (name == "failsafe" && lines.front().bytes[1] != 0x07 && protocol != 5) now_s += 0.7;
    play(name, lines);
    std::ifstream csv(folder / "emissions" / (name + "-" + std::to_string(units) + ".csv"));
    std::string row;
    std::getline(csv, row);
    while (std::getline(csv, row)) {
      std::ranges::replace(row, ',', ' ');
      std::istringstream numbers(row);
      std::size_t unit = 0, index = 0, transducer = 0;
      unsigned phase = 0, intensity = 0;
      numbers >> unit >> index;
      if (name == "sine") {  // a modulation's samples, of 10 periods each
        ASSERT_EQ(chain.unit(0).modulation({now_s, unit * 10 * 25000}), index) << "sample " << unit;
        ++emissions;
        continue;
      }
      numbers >> transducer >> phase >> intensity;
      const std::uint64_t divider = name == "foci" ? 400 : 4000;
      const EmulatedUnit::Output one = chain.unit(unit).pattern({now_s, index * divider * 25000})[transducer];
      ASSERT_EQ((std::pair<unsigned, unsigned>(one.phase, one.intensity)), std::pair(phase, intensity))
          << name << ", unit " << unit << ", index " << index << ", transducer " << transducer;
      ++emissions;
    }
  }
  EXPECT_EQ(emissions, units == 1 ? 7301u : 8964u);
}

INSTANTIATE_TEST_SUITE_P(Autd3UdpRecordings, Recorded,
                         testing::Values(std::pair("0.11", 1), std::pair("0.11", 3), std::pair("0.12", 1),
                                         std::pair("0.12", 3), std::pair("0.13", 1), std::pair("0.13", 3)));

// ---- by hand --------------------------------------------------------------------------------------------------------

/// A chain and the host's side of it, without any check of what comes back.
struct Host {
  explicit Host(ChainSetting setting) : protocol(setting.protocol), chain(setting) {}

  Bytes control(std::uint8_t kind, Bytes body = {}) const {
    Bytes datagram{protocol, kind, 7, 0};
    datagram.insert(datagram.end(), body.begin(), body.end());
    return datagram;
  }
  Bytes frame(std::uint8_t command, const Bytes& payload = {}, std::uint32_t at_us = 0) {
    Bytes datagram{protocol, 0, ++number, 0, protocol == 5 ? std::uint8_t{0} : sequence++, command};
    for (int byte = 0; protocol != 2 && byte < 4; ++byte)
      datagram.push_back(static_cast<std::uint8_t>(at_us >> (8 * byte)));
    datagram.insert(datagram.end(), payload.begin(), payload.end());
    return datagram;
  }
  std::vector<EmulatedChain::Answer> after(double seconds) {
    now_s += seconds;
    chain.advance(now_s);
    return chain.answers();
  }
  std::vector<EmulatedChain::Answer> send(std::size_t unit, const Bytes& datagram, double seconds = 12e-3) {
    chain.take(now_s, unit, datagram);
    return after(seconds);
  }
  /// The status of the only answer.
  int status(std::size_t unit, const Bytes& datagram) {
    const auto answers = send(unit, datagram);
    return answers.size() == 1 ? answers[0].bytes[datagram[1] == 0 ? 5 : 4] : -1;
  }
  void open() {
    for (std::size_t unit = 0; unit < chain.size(); ++unit) {
      EXPECT_EQ(status(unit, control(4, {static_cast<std::uint8_t>(unit), std::uint8_t{unit == 0}})), 0);
      EXPECT_EQ(status(unit, control(5)), 0);
    }
    EXPECT_EQ(status(0, control(6, Bytes(8, 0))), 0);
    after(0.1);
    for (std::size_t unit = 0; unit < chain.size(); ++unit) {
      sequence = 0;
      if (protocol != 5) {
        EXPECT_EQ(status(unit, frame(0)), 0);
      }
      sequence = 0;
      EXPECT_EQ(status(unit, frame(3)), 0);
    }
  }
  Bytes pattern(std::uint8_t bank, std::uint8_t phase, std::uint8_t intensity) const {
    Bytes payload{bank, 0xff, 0, 0, 0, 0, 0, 0, 0, 0};
    for (int t = 0; t < 249; ++t)
      payload.insert(payload.end(), {phase, intensity});
    if (protocol == 5) return payload;
    std::fill_n(payload.begin() + 10, 249, phase);
    std::fill(payload.begin() + 259, payload.end(), intensity);
    return payload;
  }
  Bytes settings(std::uint16_t failsafe_ms) const {
    Bytes payload(52, 0);
    payload[34] = static_cast<std::uint8_t>(failsafe_ms);
    payload[35] = static_cast<std::uint8_t>(failsafe_ms >> 8);
    return payload;
  }
  std::uint8_t intensity(std::size_t unit) const { return chain.unit(unit).output(chain.moment(now_s))[100].intensity; }
  std::uint32_t unit_us() const { return static_cast<std::uint32_t>(chain.moment(now_s).unit_ns / 1000); }

  std::uint8_t protocol;
  EmulatedChain chain;
  double now_s = 10;
  std::uint8_t number = 0, sequence = 0;
};

class Protocols : public testing::TestWithParam<int> {
 protected:
  ChainSetting setting(std::size_t units) const {
    return {.protocol = static_cast<std::uint8_t>(GetParam()), .units = units};
  }
};
INSTANTIATE_TEST_SUITE_P(Autd3UdpEmulated, Protocols, testing::Values(2, 3, 5));

TEST_P(Protocols, UnitsAreFoundOneBehindTheOtherAndAnswerFromAnotherAddressOnceTheyHaveAnId) {
  Host host(setting(3));
  EXPECT_EQ(host.status(0, Bytes{0xff, 1, 0, 0}), 1) << "a wrong protocol byte";
  host.chain.take_from_group(host.now_s, host.control(3));
  const auto found = host.after(2e-3);
  ASSERT_EQ(found.size(), 1u) << "only the first is reached";
  EXPECT_EQ(found[0].id, EmulatedChain::no_id);
  EXPECT_TRUE(host.send(1, host.control(3)).empty());
  EXPECT_TRUE(host.send(0, host.frame(0xeb)).empty()) << "a frame without an id is not answered";
  EXPECT_EQ(host.status(0, host.control(5)), 2) << "no id yet";
  EXPECT_EQ(host.status(0, host.control(4, {0xff, 1})), 3);
  const auto assigned = host.send(0, host.control(4, {0, 1}));
  ASSERT_EQ(assigned.size(), 1u);
  EXPECT_EQ(assigned[0].id, 0) << "from the new address";
  const auto opened = host.send(0, host.control(5));
  ASSERT_EQ(opened.size(), 1u);
  EXPECT_EQ(opened[0].bytes[5], 1) << "another unit is behind it";
  host.chain.take_from_group(host.now_s, host.control(3));
  const auto next = host.after(2e-3);
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].unit, 1u);
  host.send(1, host.control(4, {1, 0}));
  EXPECT_EQ(host.status(1, host.control(6, Bytes(8, 0))), 4) << "only the first unit's time can be set";
  host.send(0, host.control(2), 30e-3);
  EXPECT_EQ(host.chain.id(0), EmulatedChain::no_id);
  EXPECT_EQ(host.chain.id(1), 1) << "it keeps its id, but is cut off";
  EXPECT_TRUE(host.send(1, host.control(1)).empty());
}

TEST_P(Protocols, SevenFramesWaitAndTheEighthIsLost) {
  ChainSetting slow = setting(1);
  slow.processing_s = 10e-3;
  Host host(slow);
  host.open();
  for (int i = 0; i < 8; ++i)
    host.chain.take(host.now_s, 0, host.frame(4));
  const auto answers = host.after(0.1);
  EXPECT_EQ(answers.size(), 7u);
  EXPECT_NEAR(answers[6].at_s - answers[0].at_s, 60e-3, 1e-4) << "one after the other";
  EXPECT_EQ(host.chain.violation_count(), 1u);
}

TEST_P(Protocols, ADeadHostsUnitFallsSilentIfItsFailsafeIsOnAndStaysSoUntilItIsFreed) {
  Host host(setting(1));
  host.open();
  if (GetParam() == 5) {
    EXPECT_EQ(host.status(0, host.frame(5, host.settings(500))), 0);
  }
  if (GetParam() == 2) {
    Bytes raw{0, 1, 0, 0};
    raw.resize(4 + 498, 77);
    EXPECT_EQ(host.status(0, host.frame(0x15, raw)), 0);
  } else {
    EXPECT_EQ(host.status(0, host.frame(0x16, host.pattern(0, 9, 77))), 0);
  }
  EXPECT_EQ(host.intensity(0), 77);
  for (int i = 0; i < 5; ++i)
    host.send(0, host.control(7), 0.4);
  EXPECT_EQ(host.intensity(0), 77) << "heartbeats keep it on";
  host.after(0.2);
  EXPECT_EQ(host.intensity(0), 0);
  host.send(0, host.control(7));
  EXPECT_EQ(host.intensity(0), 0) << "the host is back, but has not freed it";
  EXPECT_EQ(host.status(0, host.frame(6)), 0);
  EXPECT_EQ(host.intensity(0), 77);
  EXPECT_EQ(host.chain.violation_count(), 0u);
}

TEST_P(Protocols, FramesOfAWrongLengthOrAtAForbiddenPlaceAreRefused) {
  Host host(setting(1));
  host.open();
  for (const auto& [command, payload] : std::vector<std::pair<std::uint8_t, Bytes>>{
           {0x03, Bytes(1)},
           {0x11, Bytes(13)},
           {0x11, {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff}},     // a divider of 0
           {0x11, {0, 1, 1, 0, 1, 4, 0, 0, 0, 0, 0, 0, 0xff, 0xff}},     // 1025 patterns
           {0x11, {0, 0, 1, 0, 1, 0x40, 0, 0, 4, 0, 1, 0, 0xff, 0xff}},  // 16385 samples of four foci
           {0x15, Bytes(4 + 497)},
           {0x20, {0, 0, 1, 0, 0, 0, 9}},                 // an odd place
           {0x21, {0, 0, 1, 0, 1, 0, 0, 0, 0xff, 0xff}},  // one sample
           {0x41, Bytes(31)},
           {0x42, Bytes(511)}}) {
    EXPECT_EQ(host.status(0, host.frame(command, payload)), 2) << static_cast<int>(command);
  }
  EXPECT_EQ(host.status(0, host.frame(0x99)), 1);
  // The strict silencer: 40 steps for phases, a divider of 39.
  EXPECT_EQ(host.status(0, host.frame(0x30, {2, 0, 0, 1, 0, 1, 10, 0, 40, 0})), 0);
  EXPECT_EQ(host.status(0, host.frame(0x11, {1, 1, 39, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff})), 0);
  EXPECT_EQ(host.status(0, host.frame(0x12, {1, 0xff, 0, 0, 0, 0, 0, 0, 0, 0})), 4);
}

TEST(Autd3UdpEmulated, FramesWithAMomentAreCarriedOutThenOnAllUnits) {
  for (const int protocol : {3, 5}) {
    Host host({.protocol = static_cast<std::uint8_t>(protocol), .units = 2});
    host.open();
    if (protocol == 5) {
      for (const std::size_t unit : {0u, 1u})
        EXPECT_EQ(host.status(unit, host.frame(5, host.settings(500))), 0);
    }
    const std::uint32_t at_us = host.unit_us() + 5000;
    for (const std::size_t unit : {0u, 1u}) {
      host.sequence = 1;  // of each unit, after its Clear
      host.chain.take(host.now_s, unit, host.frame(0x16, host.pattern(1, 3, 200), at_us));
    }
    EXPECT_TRUE(host.after(4.9e-3).empty());
    EXPECT_EQ(host.intensity(0) + host.intensity(1), 0);
    EXPECT_EQ(host.after(0.3e-3).size(), 2u);
    EXPECT_EQ(host.intensity(0), 200);
    EXPECT_EQ(host.intensity(1), 200);
    EXPECT_EQ(host.chain.unit(0).late() + host.chain.unit(1).late(), 0u);
    host.sequence = 2;
    EXPECT_EQ(host.status(0, host.frame(0x16, host.pattern(0, 3, 50), host.unit_us() - 10)), 0);
    EXPECT_EQ(host.intensity(0), 50) << "late, so at once";
    EXPECT_EQ(host.chain.unit(0).late(), 1u);
    EXPECT_EQ(host.chain.violation_count(), 0u);
  }
}

TEST(Autd3UdpEmulated, ProtocolsWithASequenceCarryOutNothingElse) {
  for (const int protocol : {2, 3}) {
    Host host({.protocol = static_cast<std::uint8_t>(protocol), .units = 1});
    host.open();
    const Bytes frame = host.frame(0x41, Bytes(32, 0));
    EXPECT_EQ(host.status(0, frame), 0);
    EXPECT_EQ(host.status(0, frame), 0) << "the last one again";
    EXPECT_EQ(host.chain.unit(0).carried_out(), 2u) << "with the Clear; the repeated one only answered";
    EXPECT_EQ(host.chain.violation_count(), 0u);
    host.sequence = 9;
    const auto answers = host.send(0, host.frame(4));
    ASSERT_EQ(answers.size(), 1u);
    EXPECT_EQ(answers[0].bytes[4], frame[4]) << "the number that it took last";
    EXPECT_EQ(host.chain.unit(0).carried_out(), 2u);
    EXPECT_EQ(host.chain.violation_count(), 1u);
  }
}

TEST(Autd3UdpEmulated, TellsOfSoundWithoutAFailsafe) {
  Host host({.protocol = 5});
  host.open();
  EXPECT_EQ(host.status(0, host.frame(0x16, host.pattern(0, 0, 1))), 0);
  ASSERT_EQ(host.chain.violation_count(), 1u);
  EXPECT_NE(host.chain.violations()[0].what.find("failsafe is off"), std::string::npos);
}

TEST(Autd3UdpEmulated, AUnitThatRebootsIsSilentAndCutsOffThoseBehindIt) {
  Host host({.protocol = 5, .units = 3});
  host.open();
  for (const std::size_t unit : {0u, 1u, 2u}) {
    host.status(unit, host.frame(5, host.settings(500)));
    EXPECT_EQ(host.status(unit, host.frame(0x16, host.pattern(0, 0, 9))), 0);
  }
  host.chain.take(host.now_s, 1, host.frame(4));
  host.chain.reboot(host.now_s, 1);
  EXPECT_TRUE(host.after(2e-3).empty()) << "what waited in it is gone";
  EXPECT_EQ(host.intensity(0), 9);
  EXPECT_EQ(host.intensity(1), 0);
  EXPECT_TRUE(host.send(2, host.control(1)).empty());
  EXPECT_EQ(host.chain.id(1), EmulatedChain::no_id);
}

TEST(Autd3UdpEmulated, TheWireIsSharedAndTakesTime) {
  Host host({.protocol = 5, .units = 16, .processing_s = 0});
  host.open();
  for (std::size_t unit = 0; unit < 16; ++unit)
    host.status(unit, host.frame(5, host.settings(500)));
  const double begin_s = host.now_s;
  for (std::size_t unit = 0; unit < 16; ++unit)
    host.chain.take(host.now_s, 15 - unit, host.frame(0x16, host.pattern(0, 0, 9)));
  const auto answers = host.after(20e-3);
  ASSERT_EQ(answers.size(), 16u);
  // The farthest unit's frame is sent first. All arrive together, after 16 lengths of 518 + 86 bytes on the first
  // cable; the farthest unit's answer of 16 + 86 bytes passes 16 cables.
  EXPECT_NEAR(answers.back().at_s - begin_s, 16 * 48.3e-6 + 16 * 8.2e-6, 5e-6);
}

TEST(Autd3UdpEmulated, FaultsOfTheWireAreThoseThatWereAsked) {
  const auto answered = [](ChainSetting setting) {
    setting.protocol = 5;
    Host host(setting);
    std::size_t count = 0;
    for (int i = 0; i < 1000; ++i)
      count += host.send(0, host.control(1)).size();
    count += host.after(1).size();
    return count;
  };
  EXPECT_EQ(answered({}), 1000u);
  EXPECT_NEAR(static_cast<double>(answered({.lost = 0.1})), 810, 40) << "lost on both ways";
  EXPECT_NEAR(static_cast<double>(answered({.repeated = 0.1})), 1210, 40);
  EXPECT_EQ(answered({.delayed = 0.1}), 1000u);
  EXPECT_EQ(answered({.lost = 0.1, .seed = 5}), answered({.lost = 0.1, .seed = 5}));
}

}  // namespace
}  // namespace palpa::driver::autd3_udp
