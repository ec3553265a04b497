#include "drawing/libpng.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace palpa::drawing {
namespace {

template <typename Value>
std::vector<Value> ramp(std::size_t count) {
  std::vector<Value> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = static_cast<Value>(i * 251);
  return values;
}

template <typename Value>
void expect_back(std::uint32_t width, std::uint32_t height) {
  const std::vector<Value> values = ramp<Value>(std::size_t{width} * height);
  const std::string bytes = png_of_values(width, height, std::span<const Value>(values));
  EXPECT_TRUE(begins_as_png(bytes));
  EXPECT_LE(bytes.size(), most_png_bytes(width, height, sizeof(Value)));
  PngValues png(bytes);
  EXPECT_EQ(png.width(), width);
  EXPECT_EQ(png.height(), height);
  EXPECT_TRUE(png.is_grey(8 * sizeof(Value)));
  EXPECT_EQ(png.kind(), sizeof(Value) == 2 ? "16-bit grey" : "8-bit grey");
  std::vector<Value> back(values.size());
  png.read_grey(back);
  EXPECT_EQ(back, values);
}

TEST(Libpng, ATextComesBackBesideTheValues) {
  const std::vector<std::uint16_t> values = ramp<std::uint16_t>(21);
  const std::string bytes =
      png_of_values(7, 3, std::span<const std::uint16_t>(values), {"Camera", "front left; \xc3\xa9"});
  PngValues png(bytes);
  EXPECT_EQ(png.text("Camera"), "front left; \xc3\xa9");
  EXPECT_EQ(png.text("Title"), "");
  std::vector<std::uint16_t> back(values.size());
  png.read_grey(back);
  EXPECT_EQ(back, values);
  const std::string plain = png_of_values(7, 3, std::span<const std::uint16_t>(values));
  EXPECT_EQ(PngValues(plain).text("Camera"), "");
}

TEST(Libpng, ValuesComeBackAsTheyWere) {
  expect_back<std::uint8_t>(7, 3);
  expect_back<std::uint16_t>(7, 3);
  expect_back<std::uint16_t>(300, 200);
}

TEST(Libpng, PicturesComeBackWithAnOpaqueAlpha) {
  const std::vector<std::uint8_t> rgb = ramp<std::uint8_t>(std::size_t{3} * 5 * 4);
  const std::string bytes = png_of_picture(5, 4, rgb);
  EXPECT_EQ(bytes, png_of_picture(5, 4, rgb));
  EXPECT_EQ(PngValues(bytes).kind(), "8-bit colour");
  EXPECT_FALSE(PngValues(bytes).is_grey(8));
  PngPicture picture(bytes);
  EXPECT_EQ(picture.width(), 5u);
  EXPECT_EQ(picture.height(), 4u);
  const std::vector<std::uint8_t> rgba = picture.read_rgba();
  ASSERT_EQ(rgba.size(), 80u);
  for (std::size_t i = 0; i < 20; ++i) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      EXPECT_EQ(rgba[4 * i + channel], rgb[3 * i + channel]) << i;
    EXPECT_EQ(rgba[4 * i + 3], 255) << i;
  }
}

TEST(Libpng, WhatIsBrokenIsAFaultInBothReaders) {
  const std::vector<std::uint16_t> values = ramp<std::uint16_t>(std::size_t{40} * 30);
  const std::string good = png_of_values(40, 30, std::span<const std::uint16_t>(values));
  const std::string half = good.substr(0, good.size() / 2);
  EXPECT_FALSE(begins_as_png("this is no picture"));
  EXPECT_THROW(PngValues("this is no picture"), PngFault);
  EXPECT_THROW(PngPicture("this is no picture"), PngFault);
  EXPECT_THROW(PngValues{half}, PngFault);  // a chunk that claims to be longer than the file
  EXPECT_THROW(PngPicture(half).read_rgba(), PngFault);
  std::string corrupt = good;
  corrupt[good.size() / 2] = static_cast<char>(corrupt[good.size() / 2] ^ 0x55);
  std::vector<std::uint16_t> back(values.size());
  EXPECT_THROW(PngValues(corrupt).read_grey(back), PngFault);
  EXPECT_THROW(PngPicture(corrupt).read_rgba(), PngFault);
  EXPECT_THROW(png_of_picture(0, 0, {}), PngFault);
}

}  // namespace
}  // namespace palpa::drawing
