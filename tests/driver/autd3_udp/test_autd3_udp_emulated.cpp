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

}  // namespace
}  // namespace palpa::driver::autd3_udp
