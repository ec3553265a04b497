// The data for OpenMPD boards, and the files with which a board's transducers are corrected.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
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

TEST(OpenMpdFrame, WidthsAreTheHighestStepThatIsNotAboveTheAmplitude) {
  const auto width_of = [](float amplitude) {
    openmpd::Frame frame;
    openmpd::Encoder().encode(alike(amplitude, 0), frame);
    return frame[openmpd::transducers];
  };
  EXPECT_EQ(width_of(1), 64);
  EXPECT_EQ(width_of(1.5f), 64);
  EXPECT_EQ(width_of(0), 0);
  EXPECT_EQ(width_of(-1), 0);
  EXPECT_EQ(width_of(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(width_of(std::numeric_limits<float>::infinity()), 64);
  for (unsigned width = 1; width < 64; ++width) {
    const auto amplitude = static_cast<float>(std::sin(width * pi / 128));
    EXPECT_EQ(width_of(amplitude), width);
    EXPECT_EQ(width_of(amplitude * (1 - 1e-6f)), width - 1);
  }
}

TEST(OpenMpdFrame, APulseLiesAroundItsDelayWithoutTheOffsetOfItsFile) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    double amplitude, turns;
    int degrees;
    int phase, width;
  } cases[] = {
      {1, 0.25, 0, 32, 64}, {1, -1e-9, 0, 0, 64},    {1, -0.6 / 128, 0, 127, 64}, {1, -0.4 / 128, 0, 0, 64},
      {1, nan, 0, 0, 64},   {0.5, 0, 0, 22, 21},     {0.70711, 0.5, 0, 80, 32},   {1, 0.25, 90, 0, 64},
      {1, 0, 90, 96, 64},   {0.70711, 0, 0, 16, 32}, {0, 0.3, 0, 0, 0},
  };
  for (const auto& [amplitude, turns, degrees, phase, width] : cases) {
    SCOPED_TRACE(fmt::format("{} at {} turns, {} degrees", amplitude, turns, degrees));
    openmpd::Calibration calibration;
    calibration.degrees.fill(degrees);
    openmpd::Frame frame;
    const auto phase_rad = static_cast<float>(2 * pi * turns);
    openmpd::Encoder(calibration).encode(alike(static_cast<float>(amplitude), phase_rad), frame);
    EXPECT_EQ(frame[1], phase);
    EXPECT_EQ(frame[257], width);
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
           {board_file_text("S1", {}, 0.001),
            "line 4: transducer 0 is at -0.07775 m; on an OpenMPD board it is at -0.07875 m"},
           {board_file_text("S1", {}, 0, 1),
            "line 5: transducer 0 is wired to pin 250; on an OpenMPD board it is wired to pin 249"},
           {with_last("x.0"),
            "expected the amplitude factor of transducer 255, a number from 0 to 1; found \"x.000000\""},
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
