#include <gtest/gtest.h>

#include "drawing/arrange.hpp"

namespace palpa::drawing {
namespace {

/// A picture of one grey.
Pixels plain(std::uint32_t width, std::uint32_t height, std::uint8_t grey) {
  return {width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height, grey)};
}

TEST(Arrange, HalvesByMeansOfFour) {
  Pixels picture = plain(5, 2, 10);
  picture.rgba[0] = 13;  // red of the first pixel: (13 + 3 * 10) / 4 = 10.75
  picture.rgba[4 * 2] = 11;
  const Pixels half = halved(picture);
  ASSERT_EQ(half.width, 2u);
  ASSERT_EQ(half.height, 1u);
  EXPECT_EQ(half.at(0, 0)[0], 11);
  EXPECT_EQ(half.at(0, 0)[1], 10);
  EXPECT_EQ(half.at(1, 0)[0], 10);
}

TEST(Arrange, PutsPicturesInRowsOnWhite) {
  const Pixels all = side_by_side({plain(2, 1, 1), plain(1, 3, 2), plain(1, 1, 3)}, 2);
  ASSERT_EQ(all.width, 4u);
  ASSERT_EQ(all.height, 4u) << "each row is as high as its highest picture";
  EXPECT_EQ(all.at(1, 0)[0], 1);
  EXPECT_EQ(all.at(1, 1)[0], 255);
  EXPECT_EQ(all.at(2, 2)[0], 2);
  EXPECT_EQ(all.at(3, 2)[0], 255);
  EXPECT_EQ(all.at(0, 3)[0], 3);
  EXPECT_EQ(all.at(2, 3)[0], 255);
}

}  // namespace
}  // namespace palpa::drawing
