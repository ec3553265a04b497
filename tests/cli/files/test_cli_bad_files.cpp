// Broken, hostile and absurd files for every option that takes a file: exit code 4 and one line that names the file,
// within a second and a gigabyte.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

void expect_modest(const Result& result) {
  // Sanitizers make everything slower and fatter.
  EXPECT_LT(result.processor_s, instrumented() ? 20 : slowest);
  if (!instrumented()) {
    EXPECT_LT(result.peak_mib, 1024);
  }
}

void expect_refused(const std::vector<std::string>& line, const fs::path& file) {
  RunOptions options;
  options.timeout_s = 30;
  const Result result = palpa(line, options);
  SCOPED_TRACE(line[0] + " with " + file.string());
  expect_failure(result, 4, file.string());
  expect_modest(result);
}

const char* const good_camera = R"([[camera]]
name = "test"
width = 640
height = 480
fx = 500.0
fy = 500.0
cx = 320.0
cy = 240.0
distortion = [0.0, 0.0, 0.0, 0.0, 0.0]
depth_unit_m = 0.001
min_range_m = 0.1
rate_hz = 30.0
T_world_camera = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)";

class BadFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder = scratch_folder("bad-files");
    camera = folder / "good.toml";
    write_text(camera, good_camera);
  }

  /// Gives `file` to every option that reads one, all else being good.
  void expect_refused_everywhere(const fs::path& file) {
    const std::string cube = asset("cube.glb"), finger = asset("finger.ply"), bad = file.string();
    expect_refused({"touch", "--scene", bad, "--points", finger}, file);
    expect_refused({"touch", "--scene", cube, "--points", bad}, file);
    expect_refused({"touch", "--scene", cube, "--depth", bad, "--camera", camera.string()}, file);
    expect_refused({"touch", "--scene", cube, "--depth", cube, "--camera", bad}, file);
    expect_refused({"touch", "--scene", cube, "--depth", cube, "--rig", bad}, file);
    expect_refused({"drive", "--layout", bad, "--focus", "0,0,0.1"}, file);
  }

  fs::path folder, camera;
};

TEST_F(BadFiles, Missing) {
  expect_refused_everywhere(folder / "not there.glb");
}

TEST_F(BadFiles, Directories) {
  expect_refused_everywhere(folder);
}

TEST_F(BadFiles, Empty) {
  write_text(folder / "empty", "");
  expect_refused_everywhere(folder / "empty");
}

TEST_F(BadFiles, Pipes) {
  const fs::path fifo = folder / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  expect_refused_everywhere(fifo);
}

TEST_F(BadFiles, EndlessDevices) {
  expect_refused_everywhere("/dev/zero");
}

TEST_F(BadFiles, Unreadable) {
  write_text(folder / "secret", "secret");
  fs::permissions(folder / "secret", fs::perms::none);
  expect_refused_everywhere(folder / "secret");
}

TEST_F(BadFiles, ARigsLayoutIsRefusedWithItsLine) {
  const auto refused = [&](const std::string& layout, const std::string& told) {
    write_text(folder / "rig.toml", std::string(good_camera) + "[array]\nlayout = \"" + layout + "\"\n");
    expect_failure(palpa({"run", "--scene", asset("cube.glb"), "--rig", (folder / "rig.toml").string()}), 4, told);
  };
  const std::string line = (folder / "rig.toml").string() + ": line 15: layout is ";
  refused("nope", line + "nope, neither a file nor a known layout; known: autd3");
  refused("nope.toml", line + (folder / "nope.toml").string() + ", neither a file nor a known layout");
  const std::string one = "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n";
  write_text(folder / "twice.toml", one + one);
  refused("twice.toml", (folder / "twice.toml").string() + ": line 4: transducers 0 and 1 are at the same place");
}

TEST_F(BadFiles, TenGigabytesOfZeros) {
  for (const char* name : {"zeros", "zeros.glb", "zeros.gltf"}) {
    write_text(folder / name, "");
    std::error_code error;
    fs::resize_file(folder / name, std::uintmax_t{10} << 30, error);
    if (error) GTEST_SKIP() << "skipped: no sparse files here: " << error.message();
  }
  expect_refused_everywhere(folder / "zeros");
  for (const char* name : {"zeros.glb", "zeros.gltf"}) {
    expect_refused({"touch", "--scene", (folder / name).string(), "--points", asset("finger.ply")}, folder / name);
  }
}

TEST_F(BadFiles, RandomBytes) {
  std::string bytes;
  std::uint32_t state = 1;
  for (int i = 0; i < 100000; ++i)
    bytes += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  write_text(folder / "random", bytes);
  expect_refused_everywhere(folder / "random");
  for (const std::string start :
       {"glTF", "ply\nformat ascii 1.0\n", "\x89PNG\r\n\x1a\n", "[[camera]]\n", "{\"asset\":"}) {
    write_text(folder / "random", start + bytes);
    expect_refused_everywhere(folder / "random");
  }
}

TEST_F(BadFiles, TruncatedAtEveryTenthOfItsLength) {
  for (const char* name : {"cube.glb", "finger.ply"}) {
    std::ifstream stream(asset(name), std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(stream)), {});
    for (int tenth = 1; tenth < 10; ++tenth) {
      const fs::path file = folder / (std::string("cut-") + name);
      write_text(file, whole.substr(0, whole.size() * static_cast<std::size_t>(tenth) / 10));
      if (std::string(name) == "cube.glb") {
        expect_refused({"touch", "--scene", file.string(), "--points", asset("finger.ply")}, file);
      } else {
        expect_refused({"touch", "--scene", asset("cube.glb"), "--points", file.string()}, file);
      }
    }
  }
}

TEST_F(BadFiles, EveryMalformedGltf) {
  PALPA_SHARED_OR_SKIP(root, "gltf-malformed");
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const auto extension = entry.path().extension();
    if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  EXPECT_GE(files.size(), 40u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    RunOptions options;
    options.timeout_s = 30;
    const Result result =
        palpa({"touch", "--scene", file.string(), "--points", asset("finger.ply"), "--quiet", "--log-level", "warning"},
              options);
    expect_modest(result);
    if (result.exit_code == 0) {
      // Where the fault has no bearing on the geometry.
      for (const std::string& line : result.err_lines())
        EXPECT_TRUE(line.starts_with("palpa: warning: ")) << line;
    } else {
      expect_failure(result, 4, file.filename().string());
    }
  }
}

TEST_F(BadFiles, ModelsThatAreNoSolid) {
  const fs::path file = folder / "model.glb";
  const auto refused = [&](const geometry::Mesh& mesh, const std::string& part) {
    const geometry::SceneMesh scene{"thing", mesh};
    geometry::write_glb(file, std::span(&scene, 1));
    const Result result = palpa({"touch", "--scene", file.string(), "--points", asset("finger.ply")});
    expect_failure(result, 4, file.string());
    expect_failure(result, 4, part);
  };
  geometry::Mesh open = box({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  refused(open, "open");
  refused(box({0, 0, 0}, {1, 1, 0}), "thing");
}

TEST_F(BadFiles, OfTheBenchAreRefusedBeforeItMeasures) {
  expect_refused({"bench", "--suite", "surface", "--scene", (folder / "none.glb").string()}, folder / "none.glb");
  geometry::SceneMesh open{"open", box({0, 0, 0}, {1, 1, 1})};
  open.mesh.triangles.pop_back();
  geometry::write_glb(folder / "open.glb", std::span(&open, 1));
  expect_refused({"bench", "--scene", (folder / "open.glb").string()}, folder / "open.glb");
}

TEST_F(BadFiles, PointsThatAreNoNumbers) {
  for (const char* number : {"nan", "inf", "-inf", "1e999", "x"}) {
    const fs::path file = folder / "points.ply";
    write_text(
        file, std::string("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
                          "z\nend_header\n0 0 0\n0 ") +
                  number + " 0\n");
    expect_refused({"touch", "--scene", asset("cube.glb"), "--points", file.string()}, file);
  }
  const fs::path file = folder / "points.ply";
  write_text(file,
             "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n"
             "end_header\n0 0 0\n");
  expect_refused({"touch", "--scene", asset("cube.glb"), "--points", file.string()}, file);
}

TEST_F(BadFiles, ACameraWithoutItsKeys) {
  const std::string text = good_camera;
  for (const char* key : {"width", "height", "fx", "fy", "cx", "cy"}) {
    const std::size_t at = text.find(std::string(key) + " =");
    const fs::path file = folder / "camera.toml";
    std::string without = text;
    without.erase(at, text.find('\n', at) + 1 - at);
    write_text(file, without);
    expect_refused({"touch", "--scene", asset("cube.glb"), "--depth", asset("cube.glb"), "--camera", file.string()},
                   file);
    std::string zero = text;
    zero.replace(at, text.find('\n', at) - at, std::string(key) + " = nan");
    write_text(file, zero);
    expect_refused({"touch", "--scene", asset("cube.glb"), "--depth", asset("cube.glb"), "--camera", file.string()},
                   file);
  }
}

TEST_F(BadFiles, ACameraThatDoesNotFitItsImage) {
  PALPA_SHARED_OR_SKIP(image, "depth-hand-sr305-ondris/20210326-230536_70.png");
  std::string text = good_camera;
  text.replace(text.find("width = 640"), 11, "width = 848");
  const fs::path file = folder / "camera.toml";
  write_text(file, text);
  const Result result =
      palpa({"touch", "--scene", asset("cube.glb"), "--depth", image.string(), "--camera", file.string()});
  expect_failure(result, 4, image.string());
  expect_failure(result, 4, "640x480");
  expect_failure(result, 4, "848x480");
}

}  // namespace
}  // namespace palpa::test
