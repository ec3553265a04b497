#include "sensing/grey_png.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <sys/stat.h>
#include <algorithm>

#include <chrono>
#include <random>

#include "random_rig.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

std::vector<std::uint16_t> noise_image(std::mt19937_64& random, std::size_t pixels) {
  std::vector<std::uint16_t> image(pixels);
  for (auto& pixel : image)
    pixel = static_cast<std::uint16_t>(random());
  return image;
}

std::filesystem::path scratch(const std::string& name) {
  static const std::filesystem::path folder = test::scratch_folder("grey_png");
  return folder / name;
}

/// A PNG of any kind, through libpng's other interface.
void write_other(const std::filesystem::path& file, std::uint32_t format, std::uint32_t width, std::uint32_t height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = format;
  const std::vector<std::uint16_t> pixels(std::size_t{4} * width * height, 40000);
  ASSERT_TRUE(png_image_write_to_file(&image, file.c_str(), 0, pixels.data(), 0, nullptr));
}

TEST(GreyPng, RoundTripsBitForBit) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 30; ++i) {
    const std::uint32_t width = test::uniform(random, 1, 90), height = test::uniform(random, 1, 70);
    const auto image = noise_image(random, std::size_t{width} * height);
    write_png16(scratch("a.png"), width, height, image);
    std::vector<std::uint16_t> back{1, 2, 3};
    read_png16(scratch("a.png"), width, height, back);
    EXPECT_EQ(image, back);
  }
}

TEST(GreyPng, ACameraComesBackBesideTheDepth) {
  const std::vector<std::uint16_t> image{1, 2, 3, 4, 5, 6};
  for (const std::string name : {"front left; \xc3\xa9", ""}) {
    write_png16(scratch("t.png"), 3, 2, image, name);
    std::vector<std::uint16_t> back;
    std::string camera = "another";
    read_png16(scratch("t.png"), 3, 2, back, camera);
    EXPECT_EQ(camera, name);
    EXPECT_EQ(back, image);
  }
}

TEST(GreyPng, MasksRoundTripAndAreNoDepthImages) {
  std::vector<std::uint8_t> mask(std::size_t{9} * 5), back;
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask[i] = static_cast<std::uint8_t>(i * 37);
  write_png8(scratch("m.png"), 9, 5, mask);
  read_png8(scratch("m.png"), 9, 5, back);
  EXPECT_EQ(mask, back);
  EXPECT_REFUSED(read_png8(scratch("m.png"), 5, 9, back), "m.png: is 9x5 pixels, but its camera is 5x9");
  std::vector<std::uint16_t> depth;
  EXPECT_REFUSED(read_png16(scratch("m.png"), 9, 5, depth), "but a depth image must be 16-bit grey");
  write_png16(scratch("m.png"), 9, 5, std::vector<std::uint16_t>(45));
  EXPECT_REFUSED(read_png8(scratch("m.png"), 9, 5, back), "m.png: is a 16-bit grey PNG, but a mask must be 8-bit grey");
  write_other(scratch("m.png"), PNG_FORMAT_RGB, 9, 5);
  EXPECT_REFUSED(read_png8(scratch("m.png"), 9, 5, back),
                 "m.png: is a 8-bit colour PNG, but a mask must be 8-bit grey");
}

TEST(GreyPng, IsBigEndianGreyToOthers) {
  const std::vector<std::uint16_t> image{0x0102, 0xfffe, 0, 0x8000, 7, 9};
  write_png16(scratch("b.png"), 3, 2, image);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(scratch("b.png").c_str(), "rb"), std::fclose);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, in.get());
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  EXPECT_EQ(png_get_bit_depth(png, info), 16);
  EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
  png_bytepp rows = png_get_rows(png, info);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const png_bytep at = rows[i / 3] + i % 3 * 2;
    EXPECT_EQ(at[0] << 8 | at[1], image[i]);
  }
  png_destroy_read_struct(&png, &info, nullptr);
}

TEST(GreyPng, ReadsRecordedDepth) {
  PALPA_SHARED_OR_SKIP(file, "depth-hand-sr305-ondris/20210326-230536_70.png");
  std::vector<std::uint16_t> depth;
  read_png16(file, 640, 480, depth);
  // The hand, 460 to 710 mm away in steps of 0.125 mm.
  const auto near = std::count_if(depth.begin(), depth.end(), [](std::uint16_t d) { return d > 3600 && d < 5700; });
  EXPECT_GT(near, 10000);
}

TEST(GreyPng, OtherImagesAreRefusedByName) {
  std::vector<std::uint16_t> out;
  const auto read = [&] { read_png16(scratch("c.png"), 4, 3, out); };
  write_other(scratch("c.png"), PNG_FORMAT_GRAY, 4, 3);
  EXPECT_REFUSED(read(), "c.png: is a 8-bit grey PNG, but a depth image must be 16-bit grey");
  write_other(scratch("c.png"), PNG_FORMAT_RGB, 4, 3);
  EXPECT_REFUSED(read(), "8-bit colour");
  write_other(scratch("c.png"), PNG_FORMAT_LINEAR_RGB_ALPHA, 4, 3);
  EXPECT_REFUSED(read(), "16-bit colour with alpha");
  write_png16(scratch("c.png"), 3, 4, std::vector<std::uint16_t>(12));
  EXPECT_REFUSED(read(), "c.png: is 3x4 pixels, but its camera is 4x3");
  test::write_text(scratch("c.png"), "hello, this is no image");
  EXPECT_REFUSED(read(), "c.png: is not a PNG file");
  test::write_text(scratch("c.png"), "");
  EXPECT_REFUSED(read(), "c.png: is empty");
  EXPECT_REFUSED(read_png16(scratch("none.png"), 4, 3, out), "no such file");
  EXPECT_REFUSED(read_png16("/dev/zero", 4, 3, out), "not a regular file");
  std::filesystem::resize_file(scratch("c.png"), 10'000'000'000u);
  EXPECT_REFUSED(read(), "10000000000 bytes");
}

TEST(GreyPng, TruncatedAndFlippedFilesAreRefusedOrTheSame) {
  std::mt19937_64 random(2);
  const auto image = noise_image(random, std::size_t{40} * 30);
  write_png16(scratch("d.png"), 40, 30, image);
  const std::string good = test::read_text(scratch("d.png"));
  std::vector<std::uint16_t> out;
  std::vector<std::size_t> lengths;
  for (std::size_t length = 0; length < good.size(); length += 1 + length / 20)
    lengths.push_back(length);
  for (std::size_t missing = 1; missing < 40; ++missing)
    lengths.push_back(good.size() - missing);
  for (const std::size_t length : lengths) {
    test::write_text(scratch("e.png"), good.substr(0, length));
    EXPECT_NE(test::error_of([&] { read_png16(scratch("e.png"), 40, 30, out); }), "")
        << length << " bytes of " << good.size();
  }
  // Every byte of a PNG is covered by a checksum (or is part of one): a flipped bit is rejected, unless it affects only
  // data that nobody needs.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(4);
  int refused = 0;
  for (int i = 0; i < 3000 && std::chrono::steady_clock::now() < end; ++i) {
    std::string bad = good;
    for (std::uint32_t flips = test::uniform(random, 1, 3); flips > 0; --flips) {
      const std::size_t at = i % 2 ? random() % bad.size() : random() % 60;
      bad[at] = static_cast<char>(bad[at] ^ (1 + random() % 255));
    }
    test::write_text(scratch("e.png"), bad);
    if (test::error_of([&] { read_png16(scratch("e.png"), 40, 30, out); }).empty()) {
      EXPECT_EQ(out, image);
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(GreyPng, ChunksThatPromiseWhatTheFileDoesNotHaveAreRefused) {
  write_png16(scratch("p.png"), 2, 1, std::vector<std::uint16_t>{1, 2});
  std::string bad = test::read_text(scratch("p.png"));
  const std::size_t data = bad.find("IDAT");
  bad.insert(data - 4, std::string("\x7f\xff\xff\xfftEXt", 8));
  test::write_text(scratch("q.png"), bad);
  std::vector<std::uint16_t> out;
  EXPECT_REFUSED(read_png16(scratch("q.png"), 2, 1, out), "chunk tEXt promises 2147483647 bytes");
}

TEST(GreyPng, AFullDiskIsAFailure) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "skipped: no /dev/full";
  const std::vector<std::uint16_t> image(4096, 3);
  EXPECT_ERROR(write_png16("/dev/full", 64, 64, image), Exit::failed, "/dev/full: cannot be written: No space left");
  EXPECT_ERROR(write_png16("/no/such/folder/a.png", 64, 64, image), Exit::failed, "cannot be written");
}

}  // namespace
}  // namespace palpa::sensing
