// The picture of a pattern: its path as in the plane of the hand, and its intensity in time.
#include "drawing/path_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drawing/axes.hpp"

namespace palpa::drawing {
namespace {

constexpr std::size_t count = 200;

/// What is drawn at a place of the path, and above a time of the chart.
class PathOf {
 public:
  explicit PathOf(const PathPicture& picture)
      : pixels_(draw(picture)),
        left_(pixels(30 + axis_letters) + text_pixels("-100.5", axis_letters)),
        top_(pixels(34 + 15 * static_cast<double>(picture.notes.size()))),
        wide_(pixels(340)),
        below_(top_ + wide_ + pixels(52)),
        chart_(pixels(110)) {}

  /// Whether the path passes there. As parts of the square, from the left and from below.
  bool passes(double right, double up) const {
    const auto x = static_cast<std::uint32_t>(left_ + right * wide_),
               y = static_cast<std::uint32_t>(top_ + (1 - up) * wide_);
    for (std::uint32_t v = y - 3; v <= y + 3; ++v) {
      for (std::uint32_t u = x - 3; u <= x + 3; ++u) {
        if (is_ink(u, v)) return true;
      }
    }
    return false;
  }
  /// The height of the uppermost pixel of the chart that is not its paper, as a part of the chart.
  std::optional<double> height(double part) const {
    const auto x = static_cast<std::uint32_t>(left_ + part * (wide_ - 1));
    for (std::uint32_t y = below_ + 4; y + 4 < below_ + chart_; ++y) {
      if (is_ink(x, y)) return 1 - (y - below_) / (chart_ - 1.0);
    }
    return std::nullopt;
  }

 private:
  bool is_ink(std::uint32_t x, std::uint32_t y) const {
    return *std::min_element(pixels_.at(x, y), pixels_.at(x, y) + 3) < 200;
  }

  Pixels pixels_;
  std::uint32_t left_, top_, wide_, below_, chart_;
};

/// From one corner of a square of 20 mm, given by its signs, along x and then along y. It is weaker from one fifth of
/// the time to the next.
struct Corner {
  std::vector<Vec2> places;
  std::vector<double> intensities;
  Corner(double x, double y) {
    for (std::size_t i = 0; i < count; ++i) {
      const double way = 4.0 * i / (count - 1);
      places.push_back(way < 2 ? 10.0 * Vec2(x * (1 - way), y) : 10.0 * Vec2(-x, y * (3 - way)));
      intensities.push_back(1 - 0.2 * (5 * i / count));
    }
  }
  PathPicture picture() const { return {places, intensities, 2, "a corner", {"of a square"}}; }
};

TEST(PathPicture, ThePathIsAsInThePlaneOfTheHand) {
  for (const auto& [x, y] : {std::array{1.0, 1.0}, {1.0, -1.0}, {-1.0, 1.0}, {-1.0, -1.0}}) {
    const Corner corner(x, y);
    const PathOf path(corner.picture());
    const double edge = 0.5 / 1.15;  // there is a margin
    const std::string name = "from x " + std::to_string(x) + ", y " + std::to_string(y);
    EXPECT_TRUE(path.passes(0.5, 0.5 + y * edge)) << name;
    EXPECT_TRUE(path.passes(0.5 - x * edge, 0.5)) << name;
    EXPECT_FALSE(path.passes(0.5, 0.5 - y * edge)) << name;
    EXPECT_FALSE(path.passes(0.5 + x * edge, 0.5)) << name;
  }
}

TEST(PathPicture, TheChartIsTheIntensityInTime) {
  const PathOf path(Corner(1, 1).picture());
  for (int fifth = 1; fifth < 5; ++fifth) {
    const std::optional<double> height = path.height(0.2 * fifth + 0.1);
    ASSERT_TRUE(height) << fifth;
    EXPECT_NEAR(*height, 1 - 0.2 * fifth, 0.02) << fifth;
  }
}

}  // namespace
}  // namespace palpa::drawing
