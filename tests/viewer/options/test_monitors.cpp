// Two windows on one monitor.
#include <gtest/gtest.h>

#include <optional>

#include "viewer/options/monitors.hpp"

namespace palpa::viewer {
namespace {

TEST(SideBySide, WindowsThatOverlapArePutBesideEachOther) {
  struct Case {
    const char* what;
    WindowPlace area, first, second;
    bool sized;  ///< the second has a size that was asked for
    std::optional<TwoPlaces> places;
  };
  const WindowPlace wide{0, 30, 1920, 1050}, narrow{0, 0, 1280, 1024};
  for (const Case& one : {
           Case{"apart", wide, {10, 40, 900, 620}, {920, 40, 960, 600}, false, std::nullopt},
           Case{"side by side, from edge to edge", wide, {0, 30, 900, 620}, {900, 30, 1020, 1050}, false, std::nullopt},
           Case{"the other way round", wide, {1020, 30, 900, 620}, {0, 30, 1020, 1050}, false, std::nullopt},
           Case{"one above the other", wide, {0, 30, 900, 450}, {0, 480, 960, 600}, false, std::nullopt},
           Case{"they share a column",
                wide,
                {0, 30, 900, 620},
                {899, 30, 1020, 1050},
                false,
                TwoPlaces{{0, 30, 900, 620}, {900, 30, 1020, 1050}}},
           Case{"both fit",
                wide,
                {0, 30, 900, 620},
                {0, 30, 960, 600},
                false,
                TwoPlaces{{0, 30, 900, 620}, {900, 30, 960, 600}}},
           Case{"the picture keeps its shape",
                narrow,
                {0, 0, 900, 620},
                {0, 0, 1280, 800},
                false,
                TwoPlaces{{0, 0, 640, 620}, {640, 0, 640, 400}}},
           Case{"a size is kept",
                narrow,
                {0, 0, 900, 620},
                {0, 0, 800, 600},
                true,
                TwoPlaces{{0, 0, 480, 620}, {480, 0, 800, 600}}},
       }) {
    EXPECT_EQ(side_by_side(one.area, one.first, one.second, one.sized), one.places) << one.what;
  }
  EXPECT_TRUE(side_by_side(wide, {10, 40, 900, 620}, {920, 40, 1280, 800}, false)) << "a part is off the monitor";
}

}  // namespace
}  // namespace palpa::viewer
