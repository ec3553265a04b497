// `palpa doctor` on any machine: with or without a GPU, with or without USB.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>

#include "cli/commands.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "sensing/rig.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

TEST(Doctor, ListsGpusLayerBoardsAndCameras) {
  const Result result = palpa({"doctor", "--json", "-"});
  ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 3) << result.err;
  const json report = json::parse(result.out);
  ASSERT_TRUE(report["gpus"].is_array());
  bool usable = false;
  for (const json& gpu : report["gpus"]) {
    EXPECT_TRUE(gpu["index"].is_number_integer());
    for (const char* key : {"name", "driver", "kind"})
      EXPECT_TRUE(gpu[key].is_string()) << key;
    usable |= gpu["usable"].get<bool>();
  }
  EXPECT_EQ(report["ok"].get<bool>(), usable);
  EXPECT_EQ(report["backend"], "gpu");
  EXPECT_EQ(report["backend_why"], "PALPA_BACKEND is gpu");
  EXPECT_EQ(result.exit_code, usable ? 0 : 3);
  EXPECT_TRUE(report["validation"][0]["present"].is_boolean());
  const json& features = report["features"];
  ASSERT_EQ(features.size(), 4u);
  EXPECT_EQ(features[0]["name"], "V-HACD");
  EXPECT_EQ(features[1]["name"], "liblo");
  EXPECT_EQ(features[2]["name"], "D-Bus");
  EXPECT_EQ(features[3]["name"], "SDL2");
  const json& scheduling = report["scheduling"][0];
  EXPECT_TRUE(scheduling["kept_in_memory"].is_boolean());
  EXPECT_EQ(scheduling.contains("advice"), scheduling["scheduling"] != "real-time");
  const std::string about = palpa({"--version"}).out;
  EXPECT_NE(about.find(", tinygltf 2."), std::string::npos) << about;
  for (const json& feature : features) {
    const std::string name = feature["name"];
    EXPECT_EQ(about.find("+" + name) != std::string::npos, feature["present"].get<bool>()) << about;
    EXPECT_EQ(feature.contains("advice"), !feature["present"].get<bool>());
  }
  for (const char* key : {"boards", "cameras"}) {
    ASSERT_TRUE(report[key].is_array());
    // Nothing found is never silent.
    if (report[key].empty()) {
      EXPECT_FALSE(report["notes"][key].get<std::string>().empty());
    }
  }
}

TEST(Doctor, SpeaksToPeople) {
  const Result result = palpa_here({"doctor"});
  for (const char* heading : {"GPUs", "Validation layer", "Boards", "Depth cameras"}) {
    EXPECT_NE(result.out.find(heading), std::string::npos) << heading;
  }
  if (result.exit_code == 0) {
    EXPECT_EQ(result.err, "");
  }
}

TEST(Doctor, SaysTheSchedulingThatARunGets) {
  const std::string scheduling = json::parse(palpa({"doctor", "--json", "-"}).out)["scheduling"][0]["scheduling"];
  const std::vector<std::string> run{"run",      "--scene",   source_file("assets/cube.glb").string(),
                                     "--source", "synthetic", "--link",
                                     "null",     "--backend", "cpu",
                                     "--frames", "3"};
  EXPECT_CONTAINS(palpa(run).out, "drives left by " + scheduling + " scheduling");
  std::vector<std::string> as_json = run;
  as_json.insert(as_json.end(), {"--json", "-"});
  EXPECT_EQ(json::parse(palpa(as_json).out)["scheduling"], json({{"output", scheduling}}));
}

/// The soft limit and the handler that threads in real time change, and how much memory is locked.
std::string what_scheduling_changes() {
  rlimit limit{};
  getrlimit(RLIMIT_RTTIME, &limit);
  struct sigaction action {};
  sigaction(SIGXCPU, nullptr, &action);
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line) && !line.starts_with("VmLck:")) {
  }
  return fmt::format("{} {} {}", limit.rlim_cur, action.sa_handler == SIG_DFL, line);
}

TEST(Doctor, LeavesTheSchedulingOfItsProcessAsItWasAndSoDoesARun) {
  // A service may need a hard limit as low as that.
  rlimit limit{};
  getrlimit(RLIMIT_RTTIME, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 150'000);
  setrlimit(RLIMIT_RTTIME, &limit);
  const std::string before = what_scheduling_changes();
  for (int i = 0; i < 2; ++i) {
    palpa_here({"doctor", "--quiet"});
    EXPECT_EQ(what_scheduling_changes(), before);
    palpa_here({"run", "--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--link",
                "record:/dev/null", "--backend", "cpu", "--frames", "3", "--quiet"});
    EXPECT_EQ(what_scheduling_changes(), before);
  }
}

TEST(Doctor, WithoutAGpuItAdvisesAndReturns3) {
  RunOptions none;
  none.environment = {{"VK_DRIVER_FILES", "/nonexistent.json"}, {"VK_ICD_FILENAMES", "/nonexistent.json"}};
  const Result result = palpa({"doctor", "--json", "-"}, none);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_FALSE(json::parse(result.out)["ok"].get<bool>());
  ASSERT_EQ(result.err_lines().size(), 1u) << result.err;
  EXPECT_CONTAINS(result.err, "VK_DRIVER_FILES names /nonexistent.json, which does not exist: correct or unset it");
}

TEST(Doctor, WritesARigForTheCamerasThatAreThere) {
  const std::string file = scratch_folder("doctor-rig") / "rig.toml";
  cli::CamerasThere there{.source = "v4l2:/dev/video0,/dev/video4", .cameras = {}, .problem = "/dev/video6: busy"};
  const auto doctor = [&](const std::vector<std::string>& more) {
    return palpa_here(with({"doctor", "--quiet", "--write-rig", file}, more), {},
                      [&](cli::Extensions& extensions) { extensions.cameras = [&] { return there; }; });
  };
  expect_failure(doctor({}), 1, "--write-rig: no depth camera can be opened: /dev/video6: busy");
  EXPECT_FALSE(std::filesystem::exists(file));
  for (const char* name : {"A", "B"}) {
    cli::CameraThere& camera = there.cameras.emplace_back();
    camera.camera.name = name;
    camera.camera.width = 640;
    camera.camera.height = 480;
    camera.camera.fx = camera.camera.fy = 500;
    camera.camera.device.own_lens = true;
    camera.note = "which it is";
  }
  EXPECT_EQ(doctor({}).err, "");
  const sensing::Rig rig = sensing::load_rig(file);
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].name, "B");
  EXPECT_TRUE(rig.cameras[1].device.own_lens);
  EXPECT_EQ(rig.cameras[1].T_world_camera, Transform(1.0));
  const std::string text = read_text(file);
  EXPECT_CONTAINS(text, "palpa calibrate --rig " + file + " --layout LAYOUT --source v4l2:/dev/video0,/dev/video4");
  EXPECT_CONTAINS(text, "T_world_camera is not known yet");
  expect_failure(doctor({"--source", "synthetic"}), 2, "--source");

  const std::string two = source_file("assets/rigs/openmpd-two.toml"),
                    one = source_file("assets/rigs/openmpd-one.toml");
  EXPECT_EQ(doctor({"--rig", two}).err, "");
  const sensing::Rig placed = sensing::load_rig(file), like = sensing::load_rig(two);
  ASSERT_EQ(placed.cameras.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(placed.cameras[i].name, there.cameras[i].camera.name);
    EXPECT_EQ(placed.cameras[i].T_world_camera, like.cameras[i].T_world_camera);
  }
  EXPECT_EQ(placed.array->layout, "openmpd");
  EXPECT_EQ(placed.array->T_world_layout, like.array->T_world_layout);
  EXPECT_CONTAINS(read_text(file), "palpa calibrate --rig " + file + " --source v4l2:/dev/video0,/dev/video4 --out");
  expect_failure(doctor({"--rig", one}), 4, "has 1 camera, but 2 are there");
  const std::string bare = scratch_folder("doctor-bare") / "rig.toml";
  write_text(bare, sensing::to_toml(sensing::Rig{.cameras = like.cameras}));
  expect_failure(doctor({"--rig", bare}), 4, "has no [array]");
}

TEST(Doctor, ALayoutThatMovesTheArrayOfARigIsTold) {
  const std::string rig = source_file("assets/rigs/openmpd-one.toml");
  const std::string said = "--layout openmpd puts the array at its usual place, 40 mm from the one in [array]";
  EXPECT_CONTAINS(palpa_here({"doctor", "--rig", rig, "--layout", "openmpd"}).err, said);
  EXPECT_EQ(palpa_here({"doctor", "--rig", rig}).err.find("usual place"), std::string::npos);
}

TEST(Doctor, SaysWhatTheCamerasOfARigWillSee) {
  const std::string rig = source_file("assets/rigs/openmpd-one.toml");
  const Result result = palpa_here({"doctor", "--rig", rig, "--json", "-"});
  ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 3) << result.err;
  const json cameras = json::parse(result.out)["rig"];
  ASSERT_EQ(cameras.size(), 1u) << "one camera needs no line for all together";
  EXPECT_EQ(cameras[0]["name"], "front left");
  EXPECT_GT(cameras[0]["hold"].get<double>(), 0.2);
  for (const char* object : {"cube", "semi-sphere", "pyramid", "prism"})
    EXPECT_GT(cameras[0][object].get<double>(), 0.38) << object;
  EXPECT_FALSE(cameras[0].contains("advice"));
  // A camera that nobody has placed.
  const std::string unplaced = scratch_folder("doctor-sight") / "rig.toml";
  sensing::Rig wrong = sensing::load_rig(rig);
  wrong.cameras[0].T_world_camera = Transform(1.0);
  wrong.array.reset();
  write_text(unplaced, sensing::to_toml(wrong));
  const Result told = palpa_here({"doctor", "--rig", unplaced, "--layout", "autd3"});
  EXPECT_CONTAINS(told.out, "-- front left: 0 % of a fingertip's contacts");
  EXPECT_CONTAINS(told.out, "docs/cameras.md");
  expect_failure(palpa_here({"doctor", "--rig", unplaced}), 4, "--layout");
}

TEST(Doctor, WritesTheConfigurationOfABoardsChip) {
  const std::string file = scratch_folder("doctor-eeprom") / "lab1.conf";
  const Result result = palpa_here({"doctor", "--write-eeprom", file, "--serial", "LAB1"});
  ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 3) << result.err;
  EXPECT_CONTAINS(result.out, file + ": for ftdi_eeprom");
  const std::string text = read_text(file);
  for (const char* line : {"\nvendor_id=0x0403\n", "\nproduct_id=0x6014\n", "\nserial=\"LAB1\"\n",
                           "\nuse_serial=true\n", "\ncha_type=FIFO ", "\ncha_vcp=false ", "\nfilename=old-LAB1.bin\n"})
    EXPECT_CONTAINS(text, line);
  EXPECT_CONTAINS(text, "--flash-eeprom " + file);
  for (const char* bad : {"A,B", "23@1-4", "with space", "seventeen-letters"})
    expect_failure(palpa_here({"doctor", "--write-eeprom", file, "--serial", bad}), 2, "--serial");
}

}  // namespace
}  // namespace palpa::test
