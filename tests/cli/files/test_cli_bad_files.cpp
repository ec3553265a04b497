// Missing files, folders, pipes, devices and noise for every option that takes a file: exit code 4 and one line that
// names the file. What is wrong within a file is shown by the tests of its reader.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "cli/support/process.hpp"
#include "cli/support/tiny_files.hpp"
#include "cli/support/told.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::vector<std::string>>;

class BadFiles : public testing::Test {
 protected:
  BadFiles() { write_text(camera_, tiny_camera); }

  /// `file` as the value of every option that reads one, all else being good.
  Lines lines_with(const std::string& file) const {
    return {{"touch", "--scene", file, "--points", finger_},
            {"touch", "--scene", cube_, "--points", file},
            {"touch", "--scene", cube_, "--depth", file, "--camera", camera_},
            {"touch", "--scene", cube_, "--depth", cube_, "--camera", file},
            {"touch", "--scene", cube_, "--depth", cube_, "--rig", file},
            {"drive", "--layout", file, "--focus", "0,0,0.1"}};
  }
  /// By the program, within a second and a gigabyte.
  static void expect_refused_soon(const std::vector<std::string>& line, const std::string& file) {
    SCOPED_TRACE(testing::PrintToString(line));
    RunOptions options;
    options.timeout_s = 30;
    const Result result = palpa(line, options);
    expect_failure(result, 4, file);
    // Sanitizers make everything slower and fatter.
    EXPECT_LT(result.processor_s, instrumented() ? 20 : slowest);
    if (!instrumented()) {
      EXPECT_LT(result.peak_mib, 1024);
    }
  }

  const fs::path folder_ = scratch_folder("bad-files");
  const std::string cube_ = source_file("assets/cube.glb"), finger_ = source_file("assets/finger.ply"),
                    camera_ = folder_ / "camera.toml";
};

TEST_F(BadFiles, AreRefusedByEveryOption) {
  write_text(folder_ / "empty", "");
  write_text(folder_ / "secret", "secret");
  fs::permissions(folder_ / "secret", fs::perms::none);
  std::string bytes;
  std::uint32_t state = 1;
  for (int i = 0; i < 100000; ++i)
    bytes += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  write_text(folder_ / "random", bytes);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  for (const fs::path& file : {folder_ / "not there.glb", folder_, folder_ / "empty", folder_ / "secret",
                               folder_ / "random", folder_ / "pipe", fs::path("/dev/zero")}) {
    for (const std::vector<std::string>& line : lines_with(file))
      expect_refused(line, {{{}, file, 4}});
  }
}

TEST_F(BadFiles, TenGigabytesAreRefusedAtOnce) {
  for (const char* name : {"zeros", "zeros.glb", "zeros.gltf"}) {
    write_text(folder_ / name, "");
    std::error_code error;
    fs::resize_file(folder_ / name, std::uintmax_t{10} << 30, error);
    if (error) GTEST_SKIP() << "skipped: no sparse files here: " << error.message();
  }
  Lines lines = lines_with(folder_ / "zeros");
  for (const char* name : {"zeros.glb", "zeros.gltf"})
    lines.push_back(lines_with(folder_ / name)[0]);
  for (const std::vector<std::string>& line : lines)
    expect_refused_soon(line, folder_ / "zeros");
}

TEST_F(BadFiles, OfTheBenchAreRefusedBeforeItMeasures) {
  expect_refused_soon({"bench", "--suite", "surface", "--scene", folder_ / "none.glb"}, folder_ / "none.glb");
  geometry::SceneMesh open{"open", box({0, 0, 0}, {1, 1, 1})};
  open.mesh.triangles.pop_back();
  geometry::write_glb(folder_ / "open.glb", std::span(&open, 1));
  expect_refused_soon({"bench", "--scene", folder_ / "open.glb"}, folder_ / "open.glb");
}

TEST_F(BadFiles, ARigsLayoutIsNamedWithItsLine) {
  const std::string rig = folder_ / "rig.toml", line = rig + ": line 10: layout is ";
  for (const auto& [layout, told] :
       {std::pair<std::string, std::string>{"nope", line + "nope, neither a file nor a known layout; known: autd3"},
        {"nope.toml", line + (folder_ / "nope.toml").string() + ", neither a file nor a known layout"}}) {
    write_text(rig, std::string(tiny_camera) + "[array]\nlayout = \"" + layout + "\"\n");
    expect_refused({"run", "--scene", cube_, "--rig", rig}, {{{}, told, 4}});
  }
}

TEST_F(BadFiles, ACameraThatDoesNotFitItsImageIsToldTheSizes) {
  const std::string image = folder_ / "depth.png";
  sensing::write_png16(image, 8, 5, std::vector<std::uint16_t>(40, 300));
  for (const std::string& told : {image, std::string("8x5"), std::string("8x4")})
    expect_refused({"touch", "--scene", cube_, "--depth", image, "--camera", camera_}, {{{}, told, 4}});
}

}  // namespace
}  // namespace palpa::test
