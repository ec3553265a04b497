// The data for OpenMPD boards, checked against the sound of its pulses and not against the encoder's own formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "driver/openmpd/board_file.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/openmpd/openmpd_files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
constexpr double pi = std::numbers::pi;

array::Drive alike(float amplitude, float phase) {
  return array::Drive(openmpd::transducers, {amplitude, phase});
}

/// First harmonic of a transducer that is on during counts [phase, phase + width) of 128, relative to a centred pulse
/// of half a period: amplitude, and delay as its angle in radians.
std::complex<double> sound_of(unsigned phase, unsigned width) {
  std::complex<double> sum = 0;
  for (unsigned i = 0; i < width; ++i) {
    const unsigned count = (phase + i) % 128;
    // A count is on from count to count + 1: its middle is half a count later.
    sum += std::polar(1.0, 2 * pi * (count + 0.5) / 128);
  }
  return sum * std::sin(pi / 128);
}

TEST(OpenMpdPins, AreAPermutationWiredAsTheBoardsFilesSay) {
  std::set<int> pins;
  for (std::size_t t = 0; t < openmpd::transducers; ++t)
    pins.insert(openmpd::pin_of(t));
  EXPECT_EQ(pins.size(), openmpd::transducers);
  // The corners and some neighbours, as every public board file lists them.
  EXPECT_EQ(openmpd::pin_of(0), 249);
  EXPECT_EQ(openmpd::pin_of(1), 253);
  EXPECT_EQ(openmpd::pin_of(16), 248);
  EXPECT_EQ(openmpd::pin_of(33), 254);
  EXPECT_EQ(openmpd::pin_of(64), 185);
  EXPECT_EQ(openmpd::pin_of(15), 197);
  EXPECT_EQ(openmpd::pin_of(240), 58);
  EXPECT_EQ(openmpd::pin_of(255), 7);
}

TEST(OpenMpdFrame, AnAllZeroDriveIsAllOffAndADividerSetsNothingElse) {
  openmpd::Frame frame;
  frame.fill(0xff);
  openmpd::Encoder(made_up_calibration(1)).encode(alike(0, 2.5f), frame);
  EXPECT_EQ(frame, openmpd::all_off_frame);
  openmpd::Frame expected{0x80};
  EXPECT_EQ(frame, expected);
  expected[26] = expected[28] = expected[31] = expected[33] = 0x80;  // 0xa5, the lowest bit first
  expected[34] = 0x80;                                               // and it is set
  EXPECT_EQ(openmpd::with_divider(openmpd::all_off_frame, 0xa5), expected);
}

TEST(OpenMpdFrame, WidthsFollowTheLawTruncated) {
  EXPECT_EQ(openmpd::width_of(1), 64);
  EXPECT_EQ(openmpd::width_of(1.5f), 64);
  EXPECT_EQ(openmpd::width_of(0), 0);
  EXPECT_EQ(openmpd::width_of(-1), 0);
  EXPECT_EQ(openmpd::width_of(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(openmpd::width_of(std::numeric_limits<float>::infinity()), 64);
  for (unsigned width = 1; width < 64; ++width) {  // the floats around every step
    float amplitude = static_cast<float>(std::sin(width * pi / 128));
    if (static_cast<double>(amplitude) < std::sin(width * pi / 128)) amplitude = std::nextafter(amplitude, 1.0f);
    EXPECT_EQ(openmpd::width_of(amplitude), width);
    EXPECT_EQ(openmpd::width_of(std::nextafter(amplitude, 0.0f)), width - 1);
  }
}

TEST(OpenMpdFrame, PulsesSoundAsTheDriveAsks) {
  const openmpd::Calibration calibration = made_up_calibration(7);
  const openmpd::Encoder encoder(calibration);
  std::uint32_t seed = 1;
  const auto random = [&seed] {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<double>(seed >> 8) / (1 << 24);
  };
  for (int round = 0; round < 40; ++round) {
    array::Drive drive(openmpd::transducers);
    for (auto& [amplitude, phase] : drive) {
      amplitude = static_cast<float>(random());
      phase = static_cast<float>(pi * (2 * random() - 1));
    }
    openmpd::Frame frame;
    encoder.encode(drive, frame);
    for (std::size_t i = 1; i < frame.size(); ++i)
      ASSERT_LT(frame[i], 0x80) << i;
    ASSERT_GE(frame[0], 0x80);
    for (std::size_t t = 0; t < drive.size(); ++t) {
      const unsigned pin = openmpd::pin_of(t);
      const auto sound = sound_of(frame[pin] & 0x7f, frame[256 + pin]);
      const double asked = static_cast<double>(drive[t].amplitude * calibration.factors[t]);
      ASSERT_LE(std::abs(sound), asked + 1e-6);
      ASSERT_GT(std::abs(sound), asked - pi / 128 - 1e-6);
      if (frame[256 + pin] == 0) continue;
      // The transducer's sound is late by its offset. A centred pulse of full width lies around count 32 + phase.
      const double delay = std::arg(sound * std::polar(1.0, calibration.degrees[t] * pi / 180 - pi / 2));
      const double fault = std::remainder(delay - static_cast<double>(drive[t].phase), 2 * pi);
      ASSERT_LE(std::abs(fault), pi / 128 + 1e-6) << t;
    }
  }
}

TEST(OpenMpdFrame, PhasesAreDelaysInStepsRoundedToTheNearest) {
  const openmpd::Encoder encoder(openmpd::Calibration{});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<double, int> cases[] = {{0.25, 32}, {-1e-9, 0}, {-0.6 / 128, 127}, {-0.4 / 128, 0}, {nan, 0}};
  for (const auto& [turns, step] : cases) {
    openmpd::Frame frame;
    encoder.encode(alike(1, static_cast<float>(2 * pi * turns)), frame);
    EXPECT_EQ(frame[1] & 0x7f, step) << turns;
  }
}

TEST(OpenMpdBoardFile, IsReadByTokens) {
  const auto folder = scratch_folder("openmpd-files");
  const openmpd::Calibration calibration = made_up_calibration(3);
  const auto file = folder / "board_3.pat";
  write_text(file, board_file_text("FT43NK5M", calibration));
  write_text(folder / "board_4.pat", board_file_text("23", {}));
  const openmpd::BoardFile board = openmpd::read_board_file(file);
  EXPECT_EQ(board.serial, "FT43NK5M");
  EXPECT_EQ(board.calibration, calibration);
  const auto files = openmpd::read_board_files(folder);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(openmpd::calibration_of(files, "FT43NK5M"), calibration);
  EXPECT_EQ(openmpd::calibration_of(files, "another"), openmpd::Calibration{});
}

TEST(OpenMpdBoardFile, FaultsNameFileAndLine) {
  const auto folder = scratch_folder("openmpd-bad-files");
  const auto file = folder / "board_9.pat";
  const std::string good = board_file_text("S1", {});
  const auto with_last = [&](const char* factor) {
    std::string text = good;
    return text.replace(text.rfind("1.0"), 3, factor);
  };
  openmpd::Calibration wild;
  wild.degrees[0] = 99999;
  for (const auto& [text, part] : std::vector<std::pair<std::string, const char*>>{
           {good.substr(0, good.size() / 2), "the file ends there"},
           {good + "1.0", "continues after the 256 amplitude factors"},
           // Files that are no board's are not shown.
           {"S1\n128\n128\n", "line 2: expected the number of transducers"},
           {"S1\n256\n64\n", "line 3: expected the number of phase steps"},
           {board_file_text("S1", {}, 0.001), "line 4: transducer 0 is at"},
           {board_file_text("S1", {}, 0, 1), "wired to pin"},
           {with_last("x.0"), "x.000000"},
           {with_last("2.0"), "amplitude factor of transducer 255"},
           {board_file_text("S1", wild), "phase offset of transducer 0"}}) {
    write_text(file, text);
    const std::string line = error_of([&] { openmpd::read_board_file(file); });
    EXPECT_CONTAINS(line, "board_9.pat");
    EXPECT_CONTAINS(line, part);
  }
  write_text(file, good);
  write_text(folder / "board_8.pat", board_file_text("S1", made_up_calibration(5)));
  EXPECT_REFUSED(openmpd::calibration_of(openmpd::read_board_files(folder), "S1"), "has the same serial number S1");
  const auto empty = scratch_folder("openmpd-no-files");
  EXPECT_REFUSED(openmpd::read_board_files(empty), "no board files");
  EXPECT_REFUSED(openmpd::read_board_files(empty / "none"), "cannot be read");
}

}  // namespace
}  // namespace palpa::test
