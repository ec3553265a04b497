#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "drawing/png.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::drawing {
namespace {

Pixels noise(std::uint32_t width, std::uint32_t height, unsigned seed) {
  std::mt19937 random(seed);
  Pixels pixels{width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height)};
  for (std::size_t i = 0; i < pixels.rgba.size(); ++i)
    pixels.rgba[i] = i % 4 == 3 ? 255 : random() & 255;
  return pixels;
}

TEST(Png, ReadsBackWhatItWroteAndWritesTheSameBytes) {
  const auto folder = test::scratch_folder("png");
  const Pixels pixels = noise(37, 21, 1);
  write_png(folder / "a.png", pixels);
  write_png(folder / "b.png", pixels);
  EXPECT_EQ(test::read_text(folder / "a.png"), test::read_text(folder / "b.png"));
  const Pixels back = read_png(folder / "a.png");
  EXPECT_EQ(back.width, 37u);
  EXPECT_EQ(back.height, 21u);
  EXPECT_EQ(back.rgba, pixels.rgba);
}

TEST(Png, BrokenFilesAreBadInput) {
  const auto folder = test::scratch_folder("png-broken");
  write_png(folder / "good.png", noise(64, 64, 2));
  const std::string good = test::read_text(folder / "good.png");
  std::ofstream(folder / "short.png", std::ios::binary) << good.substr(0, good.size() / 2);
  std::string corrupt = good;
  corrupt[good.size() / 2] = static_cast<char>(corrupt[good.size() / 2] ^ 0x55);
  std::ofstream(folder / "corrupt.png", std::ios::binary) << corrupt;
  std::ofstream(folder / "text.png") << "this is no picture";
  std::ofstream(folder / "empty.png") << "";
  // A header that claims 2^31 - 1 pixels on a side.
  std::string huge = good;
  for (const std::size_t at : {16, 20})
    huge.replace(at, 4, "\x7f\xff\xff\xff", 4);
  std::ofstream(folder / "huge.png", std::ios::binary) << huge;
  for (const char* name : {"short.png", "corrupt.png", "text.png", "empty.png", "huge.png", "absent.png", "."})
    EXPECT_NE(test::error_of([&] { read_png(folder / name); }), "") << name;
}

TEST(Png, AnUnwritablePlaceIsAFailureAndLeavesNothing) {
  const auto folder = test::scratch_folder("png-unwritable");
  EXPECT_ERROR(write_png(folder / "no" / "such.png", noise(4, 4, 3)), Exit::failed, "such.png");
  EXPECT_ERROR(write_png(folder / "none.png", {}), Exit::failed, "none.png: cannot encode 0x0 pixels");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "skipped: no /dev/full";
  EXPECT_ERROR(write_png("/dev/full", noise(4, 4, 3)), Exit::failed, "/dev/full");
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
}

TEST(Png, MeanDifference) {
  Pixels a = noise(10, 10, 4);
  EXPECT_EQ(mean_difference(a, a), 0);
  Pixels b = a;
  for (auto& v : a.rgba)
    v = 0;
  for (auto& v : b.rgba)
    v = 255;
  EXPECT_DOUBLE_EQ(mean_difference(a, b), 1);
  b = a;
  b.rgba[0] = 51;
  EXPECT_DOUBLE_EQ(mean_difference(a, b), 51.0 / 255 / 300);
  b = a;
  b.rgba[3] = 255;  // alpha is ignored
  EXPECT_EQ(mean_difference(a, b), 0);
}

}  // namespace
}  // namespace palpa::drawing
