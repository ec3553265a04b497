// Values exactly at the limits inside the driver, and the next ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "driver/autd3/board.hpp"
#include "driver/board.hpp"
#include "driver/cameras/match.hpp"
#include "driver/guard/board_link.hpp"
#include "driver/openmpd/board.hpp"
#include "driver/openmpd/openmpd_rig.hpp"
#include "driver/sonicsurface/board.hpp"
#include "support/thrown.hpp"

namespace palpa::driver {
namespace {

double next(double value) {
  return std::nextafter(value, std::numeric_limits<double>::infinity());
}
double before(double value) {
  return std::nextafter(value, 0.0);
}

template <typename Act>
std::string said_by(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(AtLimits, FramesOfTwoCamerasFitUpToHalfAPeriodAndItsJitter) {
  const double most_s = 0.5 + cameras::stamp_jitter_s;  // of a period of 1 s
  std::vector<std::uint32_t> chosen(2);
  const auto fit = [&](double first_s, const std::vector<double>& second_s) {
    const std::vector<double> first{first_s};
    const std::vector<cameras::Waiting> both{{first}, {second_s}};
    return cameras::match(both, 1, chosen);
  };
  for (const double way : {1.0, -1.0}) {
    EXPECT_TRUE(fit(0, {way * most_s}));
    EXPECT_FALSE(fit(0, {way * next(most_s)}));
  }
  EXPECT_TRUE(fit(0, {-0.25, 0.25}));
  EXPECT_EQ(chosen[1], 0u) << "of two that are equally near, the older one";
  EXPECT_TRUE(fit(0, {-0.25, before(0.25)}));
  EXPECT_EQ(chosen[1], 1u);
}

TEST(AtLimits, ABoardHasSlotsOfAtMostFiftyMilliseconds) {
  const array::Layout layout = array::load_layout("openmpd");
  for (const BoardKind& kind : board_kinds()) {
    const session::LinkKind link = board_link(kind, "/nonexistent/guard");
    const auto fault = [&](double slot_s) {
      return said_by([&] { link.open("x", {.layout = layout, .slot_s = slot_s}); });
    };
    EXPECT_EQ(fault(0.05).find("is too long"), std::string::npos) << fault(0.05);
    EXPECT_CONTAINS(fault(next(0.05)), "is too long: give at most 50 ms");
  }
}

TEST(AtLimits, AnOpenMpdBoardTakesAFrameInEachPeriodAtMost) {
  EXPECT_EQ(openmpd::divider_for(50e-6), 1);
  EXPECT_ERROR(openmpd::divider_for(49.9e-6), Exit::usage, "0.05 ms");
  EXPECT_EQ(openmpd::divider_for(100e-6), 2);
  EXPECT_EQ(openmpd::divider_for(99.9e-6), 1);
  EXPECT_EQ(openmpd::divider_for(200e-6), 4);
  EXPECT_EQ(openmpd::divider_for(50e-3), 4) << "the usual one";
}

TEST(AtLimits, ASerialBoardMovesFociInSlotsOfAWholeFrame) {
  test::KeptNotes notes;
  for (const std::size_t boards : {1u, 2u}) {
    array::Layout layout = array::load_layout("sonicsurface");
    if (boards == 2) {
      array::Board second = layout.boards[0];
      second.first = second.count;
      layout.boards.push_back(second);
      layout.transducers.resize(std::size_t{2} * second.count);
    }
    const double frame_s = array::find_board_type("sonicsurface")->moving_slot_s(boards);
    const auto fault = [&](double slot_s, bool foci_move) {
      return said_by([&] {
        sonicsurface::board_kind().open(
            {.argument = "/dev/ttyNONE", .files = {}, .layout = layout, .slot_s = slot_s, .foci_move = foci_move},
            notes);
      });
    };
    EXPECT_CONTAINS(fault(frame_s, true), "/dev/ttyNONE");
    EXPECT_CONTAINS(fault(before(frame_s), true), "is too short");
    EXPECT_CONTAINS(fault(before(frame_s), false), "/dev/ttyNONE");
  }
}

}  // namespace
}  // namespace palpa::driver
