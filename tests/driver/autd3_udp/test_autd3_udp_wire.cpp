// AUTD3, UDP line: the bytes of what palpa sends, beside those of the makers' own clients.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "driver/autd3_udp/wire.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::autd3_udp {
namespace {

constexpr double pi = std::numbers::pi;
using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(const std::string& hex) {
  Bytes out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return out;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    out += "0123456789abcdef"[byte >> 4];
    out += "0123456789abcdef"[byte & 15];
  }
  return out;
}

const Protocol& protocol(int byte) {
  return *find_protocol(static_cast<std::uint8_t>(byte));
}

template <typename Put>
std::string sent(int byte, const Stamp& with, const Put& put) {
  Datagram out;
  put(out, protocol(byte));
  stamp(out, protocol(byte), with);
  return to_hex(out.view());
}

TEST(Autd3UdpWire, HeadsOfFramesDifferByProtocol) {
  const auto clear = [](Datagram& to, const Protocol& p) { put_command(to, p, Command::clear); };
  const Stamp with{.id = 0x1234, .sequence = 0x56, .exec_at = 0x789abcde};
  EXPECT_EQ(sent(2, with, clear), "020034125603");
  EXPECT_EQ(sent(3, with, clear), "030034125603debc9a78");
  EXPECT_EQ(sent(5, with, clear), "050034120003debc9a78") << "frames are not counted";
  EXPECT_EQ(find_protocol(4), nullptr) << "no release speaks it";
}

TEST(Autd3UdpWire, APatternIsOrderedByProtocol) {
  std::vector<Emission> pattern(transducers);
  for (std::size_t t = 0; t < transducers; ++t)
    pattern[t] = {static_cast<std::uint8_t>(t), 255};
  const auto put = [&](Datagram& to, const Protocol& p) { put_pattern_at_once(to, p, 1, pattern); };
  const std::string three = sent(3, {.id = 4}, put), five = sent(5, {.id = 4}, put);
  EXPECT_EQ(five.substr(0, 52),
            "0500040000160000000001ff0000000000000000"
            "00ff01ff02ff");
  EXPECT_EQ(three.substr(0, 52),
            "0300040000160000000001ff0000000000000000"
            "000102030405");
  EXPECT_EQ(five.size(), 2 * 518u);
  EXPECT_EQ(three.size(), 2 * 518u);
  const auto silence = [](Datagram& to, const Protocol& p) { put_pattern_at_once(to, p, 0, {}); };
  EXPECT_EQ(sent(5, {}, silence).substr(40), std::string(2 * 498, '0'));
}

TEST(Autd3UdpWire, AFocusAsTheUnitsReadIt) {
  const FixedPoint focus{4668, 2668, 6000, 180};
  const auto put = [&](Datagram& to, const Protocol& p) { put_foci(to, p, 1, 3, std::span(&focus, 1)); };
  EXPECT_EQ(sent(2, {}, put),
            "020000000010"
            "01000c000000"
            "3c12b0290077012d");
  EXPECT_EQ(foci_in_frame(protocol(2)), 180u);
  EXPECT_EQ(foci_in_frame(protocol(3)), 179u);
  EXPECT_EQ(samples_in_frame(protocol(2)), 1440u);
  EXPECT_EQ(samples_in_frame(protocol(5)), 1436u);
}

TEST(Autd3UdpWire, TimesAreWholeMicrosecondsAndNeverAtOnce) {
  EXPECT_EQ(exec_at(0), 1u) << "0 is at once";
  EXPECT_EQ(exec_at(1), 1u);
  EXPECT_EQ(exec_at(1001), 2u);
  EXPECT_EQ(exec_at(4294967295e3), 0xffffffffu);
  EXPECT_EQ(exec_at(4294967296e3), 1u) << "the count begins again every 71 minutes";
  EXPECT_EQ(exec_at(4294967297e3 + 1), 2u);
}

TEST(Autd3UdpWire, AnswersAreReadAndWhatIsNoneIsNot) {
  const Bytes frame = from_hex("0500040000003f008b7b655e0000000008");
  const auto answer = parse_answer(frame);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->id, 4);
  EXPECT_EQ(answer->status, status_ok);
  EXPECT_EQ(answer->flags, 0x3f);
  EXPECT_EQ(answer->unit, 0);
  EXPECT_EQ(answer->time_ns, 0x5e657b8bu);
  ASSERT_EQ(answer->data.size(), 1u);
  EXPECT_EQ(answer->data[0], 8);
  const Bytes other = from_hex("0501ffff01");
  EXPECT_EQ(parse_answer(other)->status, status_wrong_protocol);
  const Bytes info = from_hex("0501070000003b00000000");
  EXPECT_EQ(parse_answer(info)->flags, 0x3b);
  for (std::size_t size = 0; size < frame.size(); ++size)
    EXPECT_EQ(parse_answer(std::span(frame).first(size)).has_value(), size >= 16) << size;
  for (const char* hex : {"05010700000033", "0301070000003b00000000", "0501", "05080000000000", "0505010000"})
    EXPECT_FALSE(parse_answer(from_hex(hex))) << hex;
}

TEST(Autd3UdpWire, BytesOfAllKindsAreReadWithoutHarm) {
  std::uint32_t seed = 1;
  Bytes bytes;
  for (int i = 0; i < 20000; ++i) {
    seed = seed * 1664525 + 1013904223;
    bytes.resize(seed % 61);
    for (std::uint8_t& byte : bytes) {
      seed = seed * 1664525 + 1013904223;
      byte = static_cast<std::uint8_t>(seed >> 24);
    }
    if (bytes.size() > 1 && i % 2 == 0) {
      bytes[0] = 3;
      bytes[1] &= 7;
    }
    const auto answer = parse_answer(bytes);
    if (!answer) continue;
    parse_versions(*answer);
    parse_late(*answer, protocol(3));
  }
}

// ---- the makers' clients -------------------------------------------------------------------------------------------

struct Line {
  bool from_host = false;
  int unit = -1;  ///< -1: the group
  Bytes bytes;
};

std::vector<Line> recorded(const std::filesystem::path& file) {
  std::vector<Line> out;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    std::istringstream words(text);
    std::string time, direction, unit, hex;
    words >> time >> direction >> unit >> hex;
    out.push_back({direction == ">", unit == "group" ? -1 : std::stoi(unit.substr(4)), from_hex(hex)});
  }
  return out;
}

/// Transducer places of a unit, from its first one, in mm.
const std::vector<Vec3>& places() {
  static const std::vector<Vec3> all = [] {
    std::vector<Vec3> places;
    array::find_board_type("autd3")->add_places(places);
    const Vec3 first = places.front();
    for (Vec3& place : places)
      place = 1e3 * (place - first);
    return places;
  }();
  return all;
}

/// A place of the recordings' array, in a unit's own frame, in mm.
Vec3 in_unit(const Vec3& place, int unit) {
  const Vec3 way = place - Vec3(unit == 0 ? 0 : unit == 1 ? 192 : 540, 0, 0);
  return unit == 2 ? Vec3(way.y, -way.x, way.z) : way;
}

/// One of the recorded phases is a hair above the middle between two steps, less than a float of radians can tell.
Emission emission_of(double turns, int intensity) {
  turns += 1e-7;
  const array::TransducerDrive drive{1.0f, static_cast<float>(2 * pi * (turns - std::round(turns)))};
  return {autd3::emission(drive).phase, static_cast<std::uint8_t>(intensity)};
}

constexpr double wavelength_mm = 8.5;
using Pattern = std::vector<Emission>;

Pattern focused(int unit, int intensity) {
  Pattern out;
  for (const Vec3& place : places()) {
    const Vec3 way = in_unit({86.7, 66.7, 150}, unit) - place;
    out.push_back(emission_of(-std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z) / wavelength_mm, intensity));
  }
  return out;
}

Pattern plane() {
  const Vec3 n = Vec3(0.2, 0.1, 0.95) / std::sqrt(0.04 + 0.01 + 0.9025);
  Pattern out;
  for (const Vec3& place : places())
    out.push_back(emission_of(-(n.x * place.x + n.y * place.y + n.z * place.z) / wavelength_mm, 128));
  return out;
}

template <typename Of>
Pattern by_number(const Of& of) {
  Pattern out;
  for (std::size_t t = 0; t < transducers; ++t) {
    const auto [phase, intensity] = of(static_cast<int>(t));
    out.push_back({static_cast<std::uint8_t>(phase), static_cast<std::uint8_t>(intensity)});
  }
  return out;
}

/// What is to be sent to each unit, frame by frame.
using Put = std::function<void(Datagram&, const Protocol&, int unit)>;
using Frames = std::vector<Put>;

Put command(Command which) {
  return [which](Datagram& to, const Protocol& p, int) { put_command(to, p, which); };
}

/// A pattern that sounds at once in bank 0.
Frames shown(const Protocol& protocol, const std::function<Pattern(int)>& pattern) {
  if (protocol.carries_time)
    return {[=](Datagram& to, const Protocol& p, int unit) { put_pattern_at_once(to, p, 0, pattern(unit)); }};
  return {[=](Datagram& to, const Protocol& p, int unit) { put_raw(to, p, 0, 0, pattern(unit)); },
          [](Datagram& to, const Protocol& p, int) { put_configure_pattern(to, p, 0, {}); },
          [](Datagram& to, const Protocol& p, int) { put_activate(to, p, Command::activate_pattern, 0); }};
}

Frames with(Frames one, const Frames& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

Frames activated(std::uint8_t bank, const BankPlay& play) {
  return {[=](Datagram& to, const Protocol& p, int) { put_configure_pattern(to, p, bank, play); },
          [=](Datagram& to, const Protocol& p, int) { put_activate(to, p, Command::activate_pattern, bank); }};
}

Frames modulated(const std::vector<std::uint8_t>& samples, std::uint16_t divider) {
  return {[=](Datagram& to, const Protocol& p, int) { put_modulation(to, p, 0, 0, samples); },
          [=](Datagram& to, const Protocol& p, int) {
            put_configure_modulation(to, p, 0, divider, static_cast<std::uint32_t>(samples.size()));
          },
          [](Datagram& to, const Protocol& p, int) { put_activate(to, p, Command::activate_modulation, 0); }};
}

Put silencer(const Silencer& setting) {
  return [=](Datagram& to, const Protocol& p, int) { put_silencer(to, p, setting); };
}

Frames intended(const std::string& step, const Protocol& protocol) {
  const auto focus = [](int unit) { return focused(unit, 255); };
  if (step == "versions") return {command(Command::read_versions)};
  if (step == "state") return {command(Command::read_state), command(Command::read_counters)};
  if (step == "clear") return {command(Command::clear), command(Command::synchronize)};
  if (step == "focus") return shown(protocol, focus);
  if (step == "at") return shown(protocol, [](int unit) { return focused(unit, 77); });
  if (step == "plane") return shown(protocol, [](int) { return plane(); });
  if (step == "raw") {
    return shown(protocol,
                 [](int u) { return by_number([u](int t) { return std::pair(5 * t + u, 7 * t + 13 * u); }); });
  }
  if (step == "rawstm" || step == "phasestm8") {
    const bool raw = step == "rawstm";
    Pattern all;
    for (int k = 0; k < (raw ? 3 : 6); ++k) {
      const Pattern one = by_number([&](int t) { return std::pair(3 * t + 40 * k, raw ? 11 * t + 50 * k : 200); });
      all.insert(all.end(), one.begin(), one.end());
    }
    const std::size_t each = raw ? raw_in_frame : phases_in_frame;
    const std::uint8_t bank = raw ? 1 : 0;
    Frames out;
    for (std::size_t first = 0; first * transducers < all.size(); first += each) {
      out.emplace_back([=](Datagram& to, const Protocol& p, int) {
        const std::size_t count = std::min(each, all.size() / transducers - first);
        const auto some = std::span(all).subspan(first * transducers, count * transducers);
        (raw ? put_raw : put_phases)(to, p, bank, static_cast<std::uint16_t>(first), some);
      });
    }
    return with(out, activated(bank, {.divider = 4000, .size = raw ? 3U : 6U}));
  }
  if (step == "foci") {
    return with(
        {[](Datagram& to, const Protocol& p, int unit) {
          std::vector<FixedPoint> foci;
          for (int k = 0; k < 10; ++k) {
            for (int j = 0; j < 4; ++j) {
              const double a = 2 * pi * k / 10 + j;
              const Vec3 at = in_unit({86.7 + 30 * std::cos(a), 66.7 + 30 * std::sin(a), 150 + 5.0 * j}, unit) / 0.025;
              foci.push_back(
                  {static_cast<std::int32_t>(std::lround(at.x)), static_cast<std::int32_t>(std::lround(at.y)),
                   static_cast<std::int32_t>(std::lround(at.z)), static_cast<std::uint8_t>(j == 0 ? 180 : 64 * j)});
            }
          }
          put_foci(to, p, 0, 0, foci);
        }},
        activated(0, {.divider = 400, .size = 10, .foci_a_sample = 4, .sound_speed_m_s = 340}));
  }
  if (step == "sine") {
    std::vector<std::uint8_t> samples;
    for (int i = 0; i < 80; ++i)
      samples.push_back(static_cast<std::uint8_t>(std::floor(128 + 127.5 * std::sin(2 * pi * 3 * i / 80))));
    return with(shown(protocol, focus), modulated(samples, 10));
  }
  if (step == "silencer") {
    return with(
        {silencer({.strict = true}), silencer({.amplitude_steps = 1, .phase_steps = 1}), silencer({.fixed_rate = 256})},
        modulated({255, 255}, 65535));
  }
  if (step == "mask") {
    return with(shown(protocol, focus), {[](Datagram& to, const Protocol& p, int) {
                  std::array<bool, transducers> on{};
                  for (std::size_t t = 0; t < transducers; ++t)
                    on[t] = t % 3 != 0;
                  put_mask(to, p, on);
                }});
  }
  if (step == "failsafe" && protocol.has_settings)
    return with(
        with({[](Datagram& to, const Protocol& p, int) { put_settings(to, p, 500); }, command(Command::read_state)},
             shown(protocol, focus)),
        {command(Command::release_failsafe)});
  if (step == "failsafe")
    return with({command(Command::read_state), command(Command::release_failsafe)}, shown(protocol, focus));
  if (step == "close" && !protocol.has_settings)
    return with({silencer({})}, shown(protocol, [](int) { return Pattern(transducers, Emission{0, 0}); }));
  if (step == "close") return shown(protocol, [](int) { return Pattern(transducers, Emission{0, 0}); });
  if (step == "open") {
    if (protocol.has_settings) return {};
    return {command(Command::reset), command(Command::read_versions), command(Command::clear),
            command(Command::synchronize)};
  }
  ADD_FAILURE() << "unknown step " << step;
  return {};
}

/// The other requests, which are told from what is recorded: each has but an id and what the first units are.
void expect_request(const Line& line, const Protocol& protocol) {
  const auto id = static_cast<std::uint16_t>(line.bytes[2] | line.bytes[3] << 8);
  const auto kind = static_cast<Kind>(line.bytes[1]);
  Datagram mine;
  if (kind == Kind::assign) {
    put_assign(mine, protocol, id, static_cast<std::uint8_t>(line.unit));
  } else if (kind == Kind::set_time) {
    put_set_time(mine, protocol, id, 0);
  } else {
    put_request(mine, protocol.byte, kind, id);
  }
  EXPECT_EQ(to_hex(mine.view()), to_hex(line.bytes));
}

class AsTheMakersClients : public testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(AsTheMakersClients, TheSameIntentIsTheSameBytes) {
  const auto& [release, byte] = GetParam();
  PALPA_SHARED_OR_SKIP(folder, std::string("autd3-udp/") + release);
  const Protocol& p = protocol(byte);
  std::size_t compared = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().stem().string(), step = name.substr(0, name.find('-'));
    // Not among what palpa sends: 4 bits a phase. The recordings of losses repeat frames of other steps.
    if (step == "phasestm4" || step == "lost") continue;
    const int units = name.back() - '0';
    const Frames frames = step == "heartbeat" ? Frames() : intended(step, p);
    std::vector<std::size_t> next(static_cast<std::size_t>(units), 0);
    for (const Line& line : recorded(file.path())) {
      if (!line.from_host) {
        const auto answer = parse_answer(line.bytes);
        ASSERT_TRUE(answer) << name;
        EXPECT_EQ(answer->protocol, byte);
        EXPECT_EQ(answer->status, status_ok) << name;
        continue;
      }
      ++compared;
      if (line.bytes[1] != 0) {
        expect_request(line, p);
        continue;
      }
      std::size_t& place = next[static_cast<std::size_t>(line.unit)];
      if (line.bytes[5] == 0 && place == 1) continue;  // the makers' clients begin with one Reset more
      ASSERT_LT(place, frames.size()) << name << ": " << to_hex(line.bytes);
      Datagram mine;
      frames[place](mine, p, line.unit);
      ++place;
      Stamp with;
      with.id = static_cast<std::uint16_t>(line.bytes[2] | line.bytes[3] << 8);
      with.sequence = line.bytes[4];
      if (p.carries_time) {
        for (std::size_t i = 0; i < 4; ++i)
          with.exec_at |= static_cast<std::uint32_t>(line.bytes[6 + i]) << (8 * i);
        EXPECT_EQ(with.exec_at != 0, step == "at");
      }
      stamp(mine, p, with);
      EXPECT_EQ(to_hex(mine.view()), to_hex(line.bytes)) << name << ", unit " << line.unit << ", frame " << place;
    }
    for (const std::size_t place : next)
      EXPECT_EQ(place, frames.size()) << name;
  }
  EXPECT_GT(compared, 80u);
}
INSTANTIATE_TEST_SUITE_P(Autd3UdpRecordings, AsTheMakersClients,
                         testing::Values(std::pair("0.11", 2), std::pair("0.12", 3), std::pair("0.13", 5)),
                         [](const auto& param) { return "Protocol" + std::to_string(param.param.second); });

TEST(Autd3UdpRecordings, VersionsAndCountersOfEachRelease) {
  for (const auto& [release, byte] : {std::pair("0.11", 2), {"0.12", 3}, {"0.13", 5}}) {
    PALPA_SHARED_OR_SKIP(folder, std::string("autd3-udp/") + release);
    for (const Line& line : recorded(folder / "versions-1.txt")) {
      if (line.from_host) continue;
      const auto versions = parse_versions(*parse_answer(line.bytes));
      ASSERT_TRUE(versions);
      EXPECT_GE(versions->cpu.minor, protocol(byte).minor_from);
      EXPECT_LE(versions->fpga.minor, protocol(byte).minor_to);
    }
    const auto state = recorded(folder / "state-1.txt");
    EXPECT_EQ(parse_late(*parse_answer(state.back().bytes), protocol(byte)).has_value(), byte != 2);
  }
}

}  // namespace
}  // namespace palpa::driver::autd3_udp
