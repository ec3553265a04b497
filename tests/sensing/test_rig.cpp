#include "sensing/rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <random>

#include "random_rig.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig_toml.hpp"
#include "support/bits.hpp"
#include "support/captured.hpp"
#include "support/damaged_text.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

using test::write_text;

const std::string camera_text = R"([[camera]]
name = "one"
width = 848
height = 480
fx = 640
fy = 640.5
cx = 423.5
cy = 239.5
distortion = [0.1, -0.2, 0.001, 0.002, 0.05]
depth_unit_m = 0.0001
min_range_m = 0.28
rate_hz = 90
T_world_camera = [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]]
)";

std::string scratch() {
  static const std::filesystem::path folder = test::scratch_folder("rig");
  return (folder / "rig.toml").string();
}

Rig load_text(const std::string& text) {
  write_text(scratch(), text);
  return load_rig(scratch());
}

/// camera_text with the line that begins with `key` replaced.
std::string with(const std::string& key, const std::string& line) {
  std::string text = camera_text;
  const std::size_t begin = text.find(key + " =");
  text.replace(begin, text.find('\n', begin) - begin, line);
  return text;
}

TEST(Rig, ReadsEveryKey) {
  const Rig rig = load_text(camera_text + R"(
[array]
layout = "openmpd"
T_world_layout = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
[screen]
width_m = 0.4
height_m = 0.3
T_world_screen = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -0.35], [0, 0, 0, 1]]
eye_m = [0, 0.1, 0.6]
)");
  ASSERT_EQ(rig.cameras.size(), 1u);
  const Camera& camera = rig.cameras[0];
  EXPECT_EQ(camera.name, "one");
  EXPECT_EQ(camera.width, 848u);
  EXPECT_EQ(camera.fy, 640.5);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{0.1, -0.2, 0.001, 0.002, 0.05}));
  EXPECT_EQ(camera.depth_unit_m, 1e-4);
  EXPECT_EQ(camera.min_range_m, 0.28);
  EXPECT_EQ(transform_point(camera.T_world_camera, Vec3(0)), Vec3(0.1, 0.2, 0.3));
  ASSERT_TRUE(rig.array && rig.array->T_world_layout && rig.screen);
  EXPECT_EQ(rig.array->layout, "openmpd");
  EXPECT_EQ(transform_point(*rig.array->T_world_layout, Vec3(1, 0, 0)), Vec3(1, 3, 3));  // rows, not columns
  EXPECT_EQ(rig.screen->eye_m, Vec3(0, 0.1, 0.6));
  EXPECT_EQ(rig.screen->T_world_screen[3].z, -0.35);
}

TEST(Rig, OptionalKeysHaveDefaults) {
  const Rig rig = load_text("[[camera]]\nwidth = 8\nheight = 4\nfx = 1\nfy = 1\ncx = 0\ncy = 0\n");
  EXPECT_EQ(rig.cameras[0].distortion, (std::array<double, 5>{}));
  EXPECT_EQ(rig.cameras[0].depth_unit_m, 0.001);
  EXPECT_EQ(rig.cameras[0].min_range_m, 0);
  EXPECT_EQ(rig.cameras[0].T_world_camera, Transform(1.0));
  EXPECT_FALSE(rig.array || rig.screen);
}

TEST(Rig, AnImplausibleDepthUnitOrPoseIsWarnedOf) {
  const auto said = [](const std::string& unit) {
    return test::stderr_of([&] { load_text(with("depth_unit_m", "depth_unit_m = " + unit)); });
  };
  EXPECT_CONTAINS(said("1"),
                  "rig.toml: line 10: depth_unit_m = 1 means depths in steps of 1 m, up to 6.55e+04 m; depth "
                  "images in millimetres have depth_unit_m = 0.001");
  EXPECT_CONTAINS(said("1e-7"), "up to 0.00655 m");
  const std::string pose = "T_world_camera = [[1, 0, 0, 0], [0, 1, 0, 300], [0, 0, 1, 400], [0, 0, 0, 1]]";
  EXPECT_CONTAINS(test::stderr_of([&] { load_text(with("T_world_camera", pose)); }),
                  "T_world_camera lies 500 m from the world's origin; if its last column is in millimetres");
  for (const char* usual : {"0.001", "0.0001", "0.0002", "0.00390625"})
    EXPECT_EQ(said(usual), "");
}

TEST(Rig, AnImplausibleLeastRangeIsWarnedOf) {
  const auto said = [](const std::string& range) {
    return test::stderr_of([&] { load_text(with("min_range_m", "min_range_m = " + range)); });
  };
  EXPECT_CONTAINS(said("280"),
                  "rig.toml: line 11: min_range_m = 280 makes all depths below 280 m no data; if it is in millimetres, "
                  "write 0.28");
  for (const char* usual : {"0", "0.28", "3"})
    EXPECT_EQ(said(usual), "");
}

TEST(Rig, ALensThatCannotBeIsWarnedOf) {
  struct Numbers {
    double fx, fy, cx, cy;
  };
  const auto said = [](const Numbers& lens) {
    std::string text = camera_text;
    for (const auto& [key, value] : {std::pair("fx", lens.fx), {"fy", lens.fy}, {"cx", lens.cx}, {"cy", lens.cy}}) {
      const std::size_t begin = text.find(std::string(key) + " =");
      text.replace(begin, text.find('\n', begin) - begin, std::string(key) + " = " + toml_number(value));
    }
    const std::size_t begin = text.find("distortion");
    text.erase(begin, text.find('\n', begin) + 1 - begin);
    return test::stderr_of([&] { load_text(text); });
  };
  const std::string place = "rig.toml: line 5: ", middle = "the middle of 848x480 pixels is (423.5, 239.5)";
  const std::pair<Numbers, std::string> odd[]{
      {{640, 640, 1300, 200}, "cx = 1300 and cy = 200 lie outside the picture: " + middle},
      {{640, 640, 400, -30}, "cx = 400 and cy = -30 lie outside the picture: " + middle},
      {{960, 960, 639.5, 359.5},
       "cx = 639.5 and cy = 359.5 are the middle of 1280x720 pixels, but the pictures have 848x480: scale fx, fy, cx "
       "and cy to this size"},
      {{640, 640, 239.5, 423.5}, "cx = 239.5 and cy = 423.5 look exchanged: " + middle},
      {{640, 640, 0.5, 0.5}, "cx = 0.5 and cy = 0.5 lie in the picture's corner; they are in pixels: " + middle},
      {{1.93, 1.93, 423.5, 239.5},
       "fx = 1.93 makes the picture 179 degrees wide; fx and fy are in pixels: a length in millimetres"},
      {{64000, 64000, 423.5, 239.5}, "fx = 64000 makes the picture 0.759 degrees wide; fx and fy are in pixels\n"},
      {{640, 64, 423.5, 239.5}, "fx = 640 and fy = 64 differ by a factor of 10, but pixels are nearly square\n"},
      {{64, 640, 239.5, 423.5}, "nearly square; cx = 239.5 and cy = 423.5 look exchanged"}};
  for (const auto& [lens, what] : odd) {
    const std::string line = said(lens);
    EXPECT_CONTAINS(line, place);
    EXPECT_CONTAINS(line, what);
    EXPECT_EQ(std::ranges::count(line, '\n'), 1);
  }
  // Off the middle, pixels that are added up in one direction, and a wide lens.
  for (const Numbers& usual : {Numbers{640, 640, 380, 260}, {640, 320, 423.5, 239.5}, {240, 240, 423.5, 239.5}})
    EXPECT_EQ(said(usual), "");
}

TEST(Rig, OfTheLensesThatWereFoundEachIsWarnedOf) {
  for (const auto& [name, what] : {std::pair("outside", "lie outside the picture"),
                                   {"exchanged", "look exchanged"},
                                   {"millimetres", "makes the picture 179 degrees wide"},
                                   {"narrow", "differ by a factor of 10"}}) {
    PALPA_SHARED_OR_SKIP(file, std::string("found-more/lens-") + name + ".toml");
    const std::string line = test::stderr_of([&] { load_rig(file); });
    EXPECT_CONTAINS(line, what);
    EXPECT_EQ(std::ranges::count(line, '\n'), 1);
  }
}

TEST(Rig, ALayoutFileIsFoundFromTheRig) {
  const Rig rig = load_text("[array]\nlayout = \"mine/board.toml\"\n");
  EXPECT_EQ(rig.array->layout, (std::filesystem::absolute(scratch()).parent_path() / "mine/board.toml").string());
  EXPECT_FALSE(rig.array->T_world_layout);
}

TEST(Rig, TextRoundTripsBitForBit) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    Rig rig;
    for (std::uint32_t c = test::uniform(random, 0, 3); c > 0; --c) {
      rig.cameras.push_back(test::random_file_camera(random));
      rig.cameras.back().name = "quoted \"back\\slash\" \xc3\xa9 " + std::to_string(c);
      rig.cameras.back().rate_hz = std::abs(normal(random)) * 1e-3;
      rig.cameras.back().distortion[2] = -0.0;
      if (c == 2) rig.cameras.back().residual_m = (i + 1) * 1e-4 / 3;
    }
    rig.array.emplace().layout = "paper";
    if (i % 2) rig.array->T_world_layout = test::random_pose(random, 1);
    Screen& screen = rig.screen.emplace();
    screen.width_m = 0.1 + std::abs(normal(random));
    screen.height_m = 3;
    screen.T_world_screen = test::random_pose(random, 1e-7);
    screen.eye_m = Vec3(normal(random), -0.0, 1e-300);
    const Rig back = load_text(to_toml(rig));
    ASSERT_EQ(back.cameras.size(), rig.cameras.size());
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      const Camera &a = rig.cameras[c], &b = back.cameras[c];
      EXPECT_EQ(a.name, b.name);
      for (double Camera::*member : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::depth_unit_m,
                                     &Camera::min_range_m, &Camera::rate_hz}) {
        EXPECT_TRUE(test::same_bits(a.*member, b.*member));
      }
      EXPECT_TRUE(test::same_bits(a.distortion, b.distortion));
      EXPECT_TRUE(test::same_bits(a.T_world_camera, b.T_world_camera));
      EXPECT_EQ(a.width, b.width);
      EXPECT_EQ(a.residual_m, b.residual_m);
    }
    EXPECT_EQ(rig.array->T_world_layout.has_value(), back.array->T_world_layout.has_value());
    EXPECT_TRUE(test::same_bits(screen.T_world_screen, back.screen->T_world_screen));
    EXPECT_TRUE(test::same_bits(screen.eye_m, back.screen->eye_m));
    EXPECT_EQ(to_toml(back), to_toml(rig));
  }
}

TEST(Rig, FaultsNameFileLineAndKey) {
  EXPECT_REFUSED(load_text(camera_text + "fz = 3\n"), "rig.toml: line 14: unknown key fz in [[camera]]");
  EXPECT_REFUSED(load_text(camera_text + "[projector]\n"), "line 14: unknown key projector");
  EXPECT_REFUSED(load_text(with("fx", "fx = 0")), "line 5: fx is 0");
  EXPECT_REFUSED(load_text(with("fx", "fx = -640")), "line 5: fx is -640");
  EXPECT_REFUSED(load_text(with("fx", "fx = nan")), "line 5: fx is nan");
  EXPECT_REFUSED(load_text(with("fx", "fx = inf")), "line 5: fx is inf");
  EXPECT_REFUSED(load_text(with("fx", "fx = \"640\"")), "line 5: fx must be a number");
  EXPECT_REFUSED(load_text(with("fx", "")), "[[camera]] fx is missing");
  EXPECT_REFUSED(load_text(with("width", "width = 0")), "line 3: width is 0");
  EXPECT_REFUSED(load_text(with("width", "width = 16385")), "line 3: width is 16385");
  EXPECT_REFUSED(load_text(with("width", "width = 1.5")), "whole number");
  EXPECT_REFUSED(load_text(with("height", "height = -1")), "line 4: height");
  EXPECT_REFUSED(load_text(with("distortion", "distortion = [1, 2, 3, 4]")), "line 9: distortion must be 5 finite");
  EXPECT_REFUSED(load_text(with("distortion", "distortion = [1, 2, 3, 4, inf]")), "line 9: distortion");
  EXPECT_REFUSED(load_text(with("distortion", "distortion = [1e300, 0, 0, 0, 0]")),
                 "rig.toml: line 9: distortion cannot be undone at pixel (0, 0)");
  // It folds back on itself before the image's corners.
  EXPECT_REFUSED(load_text(with("distortion", "distortion = [-1, 0, 0, 0, 0]")), "line 9: distortion cannot be undone");
  EXPECT_EQ(test::error_of([&] { load_text(with("distortion", "distortion = [0.1, -0.2, 0.001, 0.002, 0.05]")); }), "");
  std::string wide = with("width", "width = 4096");
  wide.replace(wide.find("height = "), 12, "height = 4096");
  EXPECT_REFUSED(load_text(wide), "rig.toml: line 3: the cameras so far have 16777216 pixels together");
  EXPECT_REFUSED(load_text(with("depth_unit_m", "depth_unit_m = 0")), "line 10: depth_unit_m");
  EXPECT_REFUSED(load_text(with("min_range_m", "min_range_m = -1")), "line 11: min_range_m");
  const std::string pose = "T_world_camera";
  EXPECT_REFUSED(load_text(with(pose, pose + " = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]")),
                 "line 13: T_world_camera");
  EXPECT_REFUSED(load_text(with(pose, pose + " = [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]")),
                 "not rigid");
  EXPECT_REFUSED(load_text(with(pose, pose + " = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]")),
                 "is a mirror image");
  EXPECT_REFUSED(load_text(with(pose, pose + " = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]")),
                 "0 0 0 1");
  EXPECT_REFUSED(load_text("camera = 3\n"), "line 1: camera must be a list of tables");
  EXPECT_REFUSED(load_text("[camera]\n"), "camera must be a list of tables");
  EXPECT_REFUSED(load_text("[array]\nlayout = \"\"\n"), "line 2: layout must be a text");
  EXPECT_REFUSED(load_text("[[camera]\n"), "line 1: not TOML");
  EXPECT_REFUSED(load_text("a = \"\xff\xfe\"\n"), "not TOML");
}

std::string mask_file() {
  return (std::filesystem::path(scratch()).parent_path() / "sleeves.png").string();
}

/// Writes the mask: everything is skin except what `ignore` selects.
template <typename Ignore>
void write_mask(std::uint32_t width, std::uint32_t height, const Ignore& ignore) {
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u)
      pixels.push_back(ignore(u, v) ? 0 : 255);
  }
  write_png8(mask_file(), width, height, pixels);
}

TEST(Rig, ReadsRegionsAndMasksOfCameras) {
  EXPECT_FALSE(ignores_pixels(load_text(camera_text).cameras[0]));
  write_mask(848, 480, [](std::uint32_t u, std::uint32_t v) { return u == 100 && v == 7; });
  const Camera roi = load_text(camera_text + "roi = [100, 0, 748, 480]\n").cameras[0];
  EXPECT_TRUE(is_ignored(roi, 99, 7));
  EXPECT_FALSE(is_ignored(roi, 100, 7) || is_ignored(roi, 847, 479));
  // The mask's path is relative to the rig.
  const Camera mask = load_text(camera_text + "mask = \"sleeves.png\"\n").cameras[0];
  EXPECT_EQ(mask.mask->file, mask_file());
  EXPECT_TRUE(is_ignored(mask, 100, 7));
  EXPECT_FALSE(is_ignored(mask, 99, 7) || is_ignored(mask, 100, 8));
  const Rig both = load_text(camera_text + "roi = [100, 0, 748, 480]\nmask = \"sleeves.png\"\n");
  EXPECT_TRUE(is_ignored(both.cameras[0], 99, 7) && is_ignored(both.cameras[0], 100, 7));
  const Rig back = load_text(to_toml(both));
  EXPECT_EQ(to_toml(back), to_toml(both));
  EXPECT_EQ(back.cameras[0].mask->pixels, mask.mask->pixels);
  EXPECT_EQ(back.cameras[0].roi->x1, 848u);
}

TEST(Rig, ReadsSettingsOfRealCameras) {
  const Camera plain = load_text(camera_text).cameras[0];
  EXPECT_FALSE(plain.device.own_lens || plain.device.exposure_s || plain.device.preset);
  const Rig set = load_text(camera_text + "calibration = \"device\"\nexposure_s = 0.004\nhardware_preset = 3\n");
  EXPECT_TRUE(set.cameras[0].device.own_lens);
  EXPECT_EQ(set.cameras[0].device.exposure_s, 0.004);
  EXPECT_EQ(set.cameras[0].device.preset, 3);
  EXPECT_EQ(to_toml(load_text(to_toml(set))), to_toml(set));
  const DeviceSetting back = load_text(to_toml(set)).cameras[0].device;
  EXPECT_TRUE(back.own_lens);
  EXPECT_EQ(back.exposure_s, 0.004);
  EXPECT_EQ(back.preset, 3);
  for (const auto& [bad, fault] : {std::pair{"calibration = \"none\"", "calibration is 'none'"},
                                   {"exposure_s = 1", "exposure_s is 1,"},
                                   {"exposure_s = -1", "exposure_s is -1,"},
                                   {"hardware_preset = 256", "hardware_preset is 256,"}}) {
    const std::string text = camera_text + bad + "\n";
    EXPECT_REFUSED(load_text(text), std::string("rig.toml: line 14: ") + fault);
  }
  EXPECT_REFUSED(load_text(camera_text + "exposure_s = 0.012\n"),
                 "rig.toml: line 14: exposure_s of 0.012 is longer than a frame at 90 Hz: at most 0.0111");
  for (const auto& [rate, most] : {std::pair{"6", "0.1666"}, {"15", "0.0666"}, {"30", "0.0333"}, {"60", "0.0166"}}) {
    const std::string text = with("rate_hz", std::string("rate_hz = ") + rate);
    EXPECT_REFUSED(load_text(text + "exposure_s = 0.19\n"), std::string("at most ") + most + ",");
    EXPECT_NO_THROW(load_text(text + "exposure_s = " + most + "\n")) << "what it says would do";
  }
  EXPECT_EQ(load_text(with("rate_hz", "rate_hz = 0") + "exposure_s = 0.012\n").cameras[0].device.exposure_s, 0.012);
}

TEST(Rig, RefusesRegionsAndMasksOutsideTheImage) {
  const auto roi = [](const std::string& value) { load_text(camera_text + "roi = " + value + "\n"); };
  EXPECT_REFUSED(roi("[0, 0, 848]"), "rig.toml: line 14: roi must be 4 finite numbers");
  EXPECT_REFUSED(roi("[0, 0, 8.5, 480]"), "line 14: roi must be four whole numbers of pixels: [x, y, width, height]");
  EXPECT_REFUSED(roi("[-1, 0, 8, 8]"), "line 14: roi must be four whole numbers");
  EXPECT_REFUSED(roi("[1, 0, 848, 480]"), "line 14: roi [1, 0, 848, 480] reaches outside of the image of 848x480");
  EXPECT_REFUSED(roi("[0, 480, 1, 1]"), "reaches outside of the image");
  EXPECT_REFUSED(roi("[0, 0, 1e9, 1]"), "line 14: roi must be");
  EXPECT_REFUSED(roi("[5, 5, 0, 8]"), "line 14: roi [5, 5, 0, 8] holds no pixel");
  const auto mask = [](const std::string& more = "") { load_text(camera_text + "mask = \"sleeves.png\"\n" + more); };
  std::filesystem::remove(mask_file());
  EXPECT_REFUSED(mask(), "rig.toml: line 14: mask " + mask_file() + ": no such file");
  write_mask(480, 848, [](auto, auto) { return false; });
  EXPECT_REFUSED(mask(), "sleeves.png: is 480x848 pixels, but its camera is 848x480");
  write_png16(mask_file(), 848, 480, std::vector<std::uint16_t>(848 * 480, 1));
  EXPECT_REFUSED(mask(), "line 14: mask " + mask_file() + ": is a 16-bit grey PNG, but a mask must be 8-bit grey");
  write_text(mask_file(), "no picture");
  EXPECT_REFUSED(mask(), "is not a PNG file");
  write_mask(848, 480, [](auto, auto) { return true; });
  EXPECT_REFUSED(mask(), "line 14: mask " + mask_file() + ": leaves this camera no pixel; pixels of 0 are ignored");
  write_mask(848, 480, [](std::uint32_t u, auto) { return u < 8; });
  EXPECT_REFUSED(mask("roi = [0, 0, 8, 8]\n"), "no pixel; pixels of 0 are ignored, and so are those outside roi");
}

std::string background_file() {
  return (std::filesystem::path(scratch()).parent_path() / "empty table.png").string();
}

TEST(Rig, ReadsABackgroundOfItsOwnCameraOnly) {
  const std::string keys = "background = \"empty table.png\"\nbackground_margin_m = 0.004\n";
  Camera camera = load_text(camera_text).cameras[0];
  EXPECT_EQ(camera.background, nullptr);
  Background learned{"elsewhere.png", std::vector<std::uint16_t>(848 * 480, 7000), 0.004};
  learned.depth[5] = 0;
  camera.background = std::make_shared<Background>(learned);
  write_background(background_file(), camera);
  const Rig rig = load_text(camera_text + keys);
  ASSERT_NE(rig.cameras[0].background, nullptr);
  EXPECT_EQ(rig.cameras[0].background->file, background_file());
  EXPECT_EQ(rig.cameras[0].background->depth, learned.depth);
  EXPECT_EQ(rig.cameras[0].background->margin_m, 0.004);
  EXPECT_FALSE(ignores_pixels(rig.cameras[0]));
  EXPECT_EQ(to_toml(load_text(to_toml(rig))), to_toml(rig));

  EXPECT_REFUSED(load_text(camera_text + "background_margin_m = 0.004\n"),
                 "line 14: background_margin_m goes with background");
  EXPECT_REFUSED(load_text(camera_text + "background = \"empty table.png\"\n"), "background_margin_m");
  EXPECT_REFUSED(load_text(with("name", "name = \"two\"") + keys),
                 "line 14: background " + background_file() +
                     ": is of the camera one with depth_unit_m = 0.0001, and this is two with depth_unit_m = 0.0001");
  EXPECT_REFUSED(load_text(with("depth_unit_m", "depth_unit_m = 0.001") + keys),
                 "this is one with depth_unit_m = 0.001");
  EXPECT_REFUSED(load_text(with("width", "width = 640") + keys),
                 "empty table.png: is 848x480 pixels, but its camera is 640x480");
  write_png8(background_file(), 848, 480, std::vector<std::uint8_t>(848 * 480, 1));
  EXPECT_REFUSED(load_text(camera_text + keys), "is a 8-bit grey PNG, but a background must be 16-bit grey");
  write_png16(background_file(), 848, 480, learned.depth);  // of any program: it does not say of which camera
  EXPECT_EQ(load_text(camera_text + keys).cameras[0].background->depth, learned.depth);
  std::filesystem::remove(background_file());
  EXPECT_REFUSED(load_text(camera_text + keys), "line 14: background " + background_file() + ": no such file");
}

TEST(Rig, ReadsTheRoom) {
  const Rig rig = load_text(camera_text + "[room]\nlow_m = [-0.3, -0.1, -0.25]\nhigh_m = [0.3, 0.5, 0.125]\n");
  ASSERT_TRUE(rig.room.has_value());
  EXPECT_EQ(rig.room->box.low, Vec3(-0.3, -0.1, -0.25));
  EXPECT_EQ(rig.room->box.high, Vec3(0.3, 0.5, 0.125));
  EXPECT_EQ(rig.room->where, scratch() + ": line 14");
  EXPECT_EQ(to_toml(load_text(to_toml(rig))), to_toml(rig));
  EXPECT_FALSE(load_text(camera_text).room.has_value());
  EXPECT_REFUSED(load_text(camera_text + "[room]\nlow_m = [0, 0, 0]\nhigh_m = [1, 0, 1]\n"),
                 "line 16: high_m must be above low_m in x, y and z, but 0 is not above 0");
  EXPECT_REFUSED(load_text(camera_text + "[room]\nlow_m = [0, 0]\nhigh_m = [1, 1, 1]\n"), "low_m must be 3");
  EXPECT_REFUSED(load_text(camera_text + "[room]\nlow_m = [0, 0, 0]\nhigh_m = [1, 1, 1e9]\n"),
                 "line 16: the room reaches");
  EXPECT_REFUSED(load_text(camera_text + "[room]\nlow_m = [0, 0, 0]\n"), "high_m");
  EXPECT_REFUSED(load_text(camera_text + "[room]\nsize = 3\n"), "low_m");
}

TEST(Rig, HasAtMost64Cameras) {
  std::string many;
  for (int i = 0; i < 65; ++i)
    many += with("width", "width = 64");
  EXPECT_REFUSED(load_text(many), "more than 64 cameras");
}

TEST(Rig, MutatedFilesLoadOrAreRefused) {
  std::mt19937_64 random(99);
  const std::string good = test::read_text(test::source_file("assets/rigs/paper.toml"));
  ASSERT_FALSE(good.empty());
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(4);
  int loaded = 0, refused = 0;
  for (int i = 0; i < 4000 && std::chrono::steady_clock::now() < end; ++i) {
    const std::string line = test::error_of([&] { load_text(test::damaged(good, random)); });
    ++(line.empty() ? loaded : refused);
  }
  // However few a slow machine processed in the time.
  EXPECT_GT(loaded + refused, 10);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace palpa::sensing
