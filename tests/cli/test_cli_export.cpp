// `palpa export`: a recording's foci, events and drives on its own clock.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "array/drive.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "driver/cameras/made_up_bag.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/load.hpp"
#include "support/csv.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

constexpr double slot_s = 1.5e-3, hold_s = 0.1;

class CliExport : public testing::Test {
 protected:
  std::filesystem::path folder = scratch_folder("export");
  std::string cube = source_file("assets/cube.glb").string();
  std::vector<double> times;  ///< of the frames of the newest take

  std::string in(const std::string& name) const { return (folder / name).string(); }

  static std::filesystem::path recorded() {
    const auto take = scratch_folder("take") / "take";
    succeeded(palpa_here({"run", "--scene", source_file("assets/cube.glb").string(), "--frames", "12", "--every-frame",
                          "--backend", "cpu", "--record", take.string(), "--quiet"}));
    return take;
  }

  /// 12 frames of the synthetic finger; frames from `whole` on are `later_s` seconds later.
  std::string take(std::size_t whole = 12, double later_s = 0) {
    static const std::filesystem::path made = recorded();
    const std::string take = in("take"), table = take + "/times.csv";
    std::filesystem::copy(made, take);
    const std::string text = read_text(table);
    std::string changed = text.substr(0, text.find('\n') + 1);
    times.clear();
    for (const std::vector<double>& row : read_csv(table)) {
      const double late = times.size() < whole ? 0 : later_s;
      changed += fmt::format("{}", static_cast<int>(row[0]));
      for (std::size_t camera = 1; camera < row.size(); ++camera)
        changed += fmt::format(",{}", row[camera] + late);
      changed += '\n';
      times.push_back(*std::min_element(row.begin() + 1, row.end()) + late);
    }
    write_text(table, changed);
    return "recording:" + take;
  }

  /// Expects success. On the processor: TheSameBytesEachTimeAndOnBothBackends shows that the backend makes no
  /// difference.
  Result exported(const std::string& source, const std::vector<std::string>& outputs,
                  const std::string& backend = "cpu") const {
    const Result result =
        succeeded(palpa_here(with({"export", "--scene", cube, "--source", source, "--backend", backend}, outputs)));
    return result;
  }
  /// They end in silence.
  std::vector<RecordedDrive> drives(const std::string& name = "d.bin") const {
    return read_to_silence(in(name)).drives;
  }
  json read(const std::string& name) const { return json::parse(read_text(in(name))); }
  std::uint64_t slot_of(double time_s) const {
    return static_cast<std::uint64_t>(std::ceil((time_s - times.front()) / slot_s - 1e-6));
  }
};

TEST_F(CliExport, TheSameBytesEachTimeAndOnBothBackends) {
  const std::string source = take();
  const std::vector<std::string> names{"f.json", "e.jsonl", "d.bin"};
  std::vector<std::vector<std::string>> all;
  for (const std::string backend : {"gpu", "gpu", "cpu"}) {
    exported(source, {"--foci", in("f.json"), "--events", in("e.jsonl"), "--drives", in("d.bin"), "--quiet"}, backend);
    std::vector<std::string>& contents = all.emplace_back();
    for (const std::string& name : names)
      contents.push_back(read_text(in(name)));
  }
  for (std::size_t n = 0; n < names.size(); ++n) {
    EXPECT_GT(all[0][n].size(), 500u) << names[n];
    EXPECT_TRUE(all[0][n] == all[1][n]) << names[n];
    // Drives of both are within rounding of each other, not the same.
    EXPECT_TRUE(names[n] == "d.bin" || all[0][n] == all[2][n]) << names[n];
  }
}

TEST_F(CliExport, EachSlotPlaysTheNewestFrameByThen) {
  const Result result = exported(take(), {"--foci", in("f.json"), "--drives", in("d.bin"), "--json", in("s.json")});
  EXPECT_TRUE(result.out.starts_with("12 frames, 12 with a touch; ")) << result.out;
  const json foci = read("f.json"), stats = read("s.json");
  EXPECT_EQ(foci["slot_s"], slot_s);
  const json& frames = foci["frames"];
  ASSERT_EQ(frames.size(), times.size() + 1);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_EQ(frames[k]["time_s"], times[k]);
    EXPECT_EQ(frames[k]["slot"], slot_of(times[k]));
  }
  const std::uint64_t end = slot_of(times.back() + hold_s);
  EXPECT_EQ(frames.back()["slot"], end);
  EXPECT_TRUE(frames.back()["fingers"].empty());
  EXPECT_EQ(stats["drives"], end);
  EXPECT_EQ(stats["silent_drives"], 0);
  EXPECT_FALSE(stats.contains("fingers") || frames[0]["fingers"][0].contains("pressure_pa")) << "nobody asked for one";

  const std::vector<RecordedDrive> recorded = drives();
  ASSERT_EQ(recorded.size(), end + 1);
  const array::Layout layout = setup::load_posed_rig({}).layout;
  std::size_t frame = 0;
  for (std::uint64_t slot = 0; slot < end; ++slot) {
    while (frame + 1 < times.size() && slot >= slot_of(times[frame + 1]))
      ++frame;
    const RecordedDrive& played = recorded[slot];
    ASSERT_EQ(played.slot, slot);
    const json& finger = frames[frame]["fingers"][0];
    const json& order = finger["order"];
    const json& at = finger["foci_m"][order[slot % order.size()].get<std::size_t>()];
    const array::SlotFocus focus{Vec3(at[0], at[1], at[2]), 1};
    array::Drive wanted(layout.transducers.size());
    array::drive_for(layout, std::span(&focus, 1), setup::drive_options({}, layout, setup::Solving::by_slot), wanted);
    for (std::size_t t = 0; t < wanted.size(); t += 97) {
      ASSERT_NEAR(played.drive[t].amplitude, wanted[t].amplitude, 1e-5) << slot;
      ASSERT_LT(std::abs(std::remainder(played.drive[t].phase - wanted[t].phase, 2 * std::numbers::pi)), 1e-3) << slot;
    }
  }
}

TEST_F(CliExport, WhereNoFrameCameThereIsSilence) {
  exported(take(6, 0.3), {"--drives", in("d.bin"), "--events", in("e.jsonl"), "--quiet"});
  const std::uint64_t from = slot_of(times[5] + hold_s), until = slot_of(times[6]);
  ASSERT_GT(until, from + 100);
  const std::vector<RecordedDrive> recorded = drives();
  for (const RecordedDrive& played : recorded) {
    const bool gap = played.slot >= from && played.slot < until;
    EXPECT_EQ(loudest(played.drive) == 0, gap || played.slot == recorded.back().slot) << played.slot;
  }
  std::vector<std::string> kinds;
  std::istringstream lines(read_text(in("e.jsonl")));
  for (std::string line; std::getline(lines, line);) {
    const std::string kind = json::parse(line)["event"];
    if (kind != "move" && kind != "press") kinds.push_back(kind);
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"touch", "release", "touch", "release"}));
}

TEST_F(CliExport, APauseOfDaysCostsNothing) {
  exported(take(6, 1e6), {"--layout", "openmpd", "--drives", in("d.bin"), "--quiet"});
  const std::vector<RecordedDrive> recorded = drives();
  EXPECT_LT(recorded.size(), 7500u) << "ten seconds of silence and what sounds";
  const auto again = std::ranges::find(recorded, slot_of(times[6]), &RecordedDrive::slot);
  ASSERT_NE(again, recorded.end());
  EXPECT_GT(loudest(again->drive), 0);
  EXPECT_EQ(loudest(std::prev(again)->drive), 0);
}

TEST_F(CliExport, AShortDwellMakesAPauseNoLonger) {
  exported(take(6, 3), {"--dwell", "100us", "--events", in("e.jsonl"), "--json", in("s.json"), "--quiet"});
  const json stats = read("s.json");
  EXPECT_EQ(stats["silent_drives"], 10'000) << "of three seconds";
  EXPECT_GT(stats["drives"], 12'000);
}

TEST_F(CliExport, WhatCannotBeFinishedReplacesNothing) {
  const std::string source = take();
  write_text(in("f.csv"), "of before");
  std::filesystem::resize_file(in("take/000008-0.png"), 30);
  EXPECT_EQ(palpa_here({"export", "--scene", cube, "--source", source, "--backend", "cpu", "--foci", in("f.csv"),
                        "--events", in("e.jsonl"), "--quiet"})
                .exit_code,
            4);
  EXPECT_EQ(read_text(in("f.csv")), "of before");
  const std::string events = read_text(in("e.jsonl"));
  EXPECT_CONTAINS(events, "\"release\"");  // who touches lets go
  EXPECT_TRUE(events.ends_with("}\n"));
}

TEST_F(CliExport, EventsWithoutTheirLastLineAreAFailure) {
  const std::vector<std::string> line{
      "export",    "--scene", cube,      "--source", "recording:" + source_file("assets/depth/take").string(),
      "--backend", "cpu",     "--quiet", "--events", in("e.jsonl")};
  succeeded(palpa_here(line));
  const std::string events = read_text(in("e.jsonl"));
  const std::size_t last = events.rfind('\n', events.size() - 2) + 1;
  EXPECT_CONTAINS(events.substr(last), "\"release\"");
  const FileSizeLimit full(events.size() - 5);
  expect_failure(palpa_here(line), 1, in("e.jsonl") + ": cannot be written: File too large");
  EXPECT_EQ(read_text(in("e.jsonl")), events.substr(0, last));
}

TEST_F(CliExport, ABagEndsByItselfToo) {
  const driver::rosbag::test::MadeUpBag bag;
  const auto bytes = bag.bytes();
  write_text(in("take.bag"), std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  exported("bag:" + in("take.bag"), {"--foci", in("f.json"), "--json", in("all.json")});
  EXPECT_EQ(read("all.json")["frames"], bag.times_s.size());
}

TEST_F(CliExport, FociThatWerePlayedHaveTheSameDrivesAgain) {
  const std::string source = take(6, 0.5);  // with a pause
  const struct {
    std::vector<std::string> options, again;
    double tolerance;  ///< of amplitudes; 0: the same bytes
  } cases[] = {
      {{}, {}, 0},
      {{"--method", "multi-focus"}, {}, 0},
      {{"--method", "single-focus", "--modulation", "amplitude-sine", "--modulation-frequency", "130Hz"}, {}, 0},
      {{"--foci-count", "7", "--dwell", "2ms"}, {}, 0},
      {{"--ceiling", "0.5"}, {}, 1e-6},
      {{"--pressure", "2kPa"}, {}, 1e-3},
      {{"--pressure", "2kPa", "--ceiling", "0.5"}, {}, 1e-3}};
  for (const auto& [options, again, tolerance] : cases) {
    SCOPED_TRACE(testing::PrintToString(options));
    exported(source, with(options, {"--foci", in("f.json"), "--drives", in("d.bin"), "--quiet"}));
    succeeded(palpa_here(with({"export", "--played", in("f.json"), "--drives", in("again.bin"), "--quiet"}, again)));
    if (tolerance == 0) {
      EXPECT_TRUE(read_text(in("d.bin")) == read_text(in("again.bin")));
      continue;
    }
    const std::vector<RecordedDrive> first = drives(), second = drives("again.bin");
    ASSERT_EQ(second.size(), first.size());
    double farthest = 0;
    for (std::size_t n = 0; n < first.size(); ++n) {
      ASSERT_EQ(second[n].slot, first[n].slot);
      for (std::size_t k = 0; k < first[n].drive.size(); ++k) {
        const array::TransducerDrive &a = first[n].drive[k], &b = second[n].drive[k];
        farthest = std::max(
            farthest, std::abs(std::polar<double>(a.amplitude, a.phase) - std::polar<double>(b.amplitude, b.phase)));
      }
    }
    EXPECT_LE(farthest, tolerance);
  }
}

TEST_F(CliExport, FociWhoseGainsChangeHaveTheSameDrivesAgain) {
  const std::string source = take();
  auto meshes = geometry::load_gltf(cube).meshes;
  meshes.at(0).haptics.intensity = 0.7;
  meshes.at(0).haptics.stiffness = std::vector<geometry::DepthForce>{{0, 0.1}, {0.01, 1}};
  meshes.at(0).haptics.texture = {0.3, 1, 0.6};
  geometry::write_glb(in("scene.glb"), meshes);
  cube = in("scene.glb");
  for (const char* method : {"cross-section", "single-focus"}) {
    succeeded(exported(source, {"--method", method, "--foci", in("f.json"), "--drives", in("d.bin"), "--quiet"}));
    EXPECT_CONTAINS(read_text(in("f.json")), "\"gains\":");
    succeeded(palpa_here({"export", "--played", in("f.json"), "--drives", in("again.bin"), "--quiet"}));
    EXPECT_TRUE(read_text(in("d.bin")) == read_text(in("again.bin"))) << method;
  }
}

TEST_F(CliExport, PlayedFociAreReadOrRefusedWithTheirPlace) {
  const auto play = [&](const std::string& frames) {
    write_text(in("f.json"), R"({"slot_s": 0.0015, "frames": [)" + frames + "]}");
    return palpa_here({"export", "--played", in("f.json"), "--layout", "openmpd", "--drives", in("d.bin"), "--json",
                       in("s.json"), "--quiet"});
  };
  const std::string first = R"({"slot": 1000000, "time_s": 5, "fingers": [{"id": 3, "solid": "cube",
      "foci_m": [[0, 0.15, 0], [0.01, 0.15, 0]], "order": [1, 0], "dwell_s": 0.0015, "modulation_hz": 0,
      "gain": 0.5}]})";
  ASSERT_EQ(play(first).exit_code, 0);
  // The last frame sounds for the hold; the first slot is that of the file.
  const std::vector<RecordedDrive> recorded = drives();
  ASSERT_EQ(recorded.size(), 68u);
  EXPECT_EQ(recorded.front().slot, 1000000u);
  EXPECT_GT(loudest(recorded[66].drive), 0);
  EXPECT_EQ(read("s.json")["drives"], 67);

  const auto changed = [&](const std::string& part, const std::string& by) {
    const std::size_t at = first.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return std::string(first).replace(at, part.size(), by);
  };
  // Gains that change begin with the frame's slot, and the last one stays.
  const std::string gain = R"("gain": 0.5)", hz = R"("modulation_hz": 0)";
  const std::string slots = R"(, "slot_s": 0.0015, "gains": )";
  ASSERT_EQ(play(changed(gain, gain + slots + "[1, 0, 0.5]")).exit_code, 0);
  const std::vector<RecordedDrive> changing = drives();
  ASSERT_EQ(changing.size(), 68u);
  EXPECT_EQ(changing[0].drive[7].amplitude, recorded[0].drive[7].amplitude);
  EXPECT_EQ(loudest(changing[1].drive), 0);
  EXPECT_NEAR(changing[40].drive[7].amplitude, 0.5F * recorded[40].drive[7].amplitude, 1e-6);

  const std::string frame = "f.json: frame 0", finger = "frame 0, finger 0: ";
  const std::pair<std::string, std::string> wrong[]{
      {changed("1000000", "-1"), frame},
      {changed("\"slot\"", "\"slat\""), frame},
      {changed("[1, 0]", "[1, 2]"), finger + "its order plays focus 2 of 2 foci"},
      {changed("[1, 0]", "[[1, 0], [1]]"), finger + "the lists in"},
      {changed("[0, 0.15, 0]", "[0, null, 0]"), finger + "\"foci_m\""},
      {changed("0.5", "1.5"), finger + "\"gain\""},
      {changed("0.0015", "0.0001"), finger + "\"dwell_s\""},
      {changed(hz, R"("modulation_hz": 200, "modulation": "triangle")"), finger + "\"modulation\""},
      {changed(gain, gain + slots + "[0.5, 2]"), finger + "\"gains\""},
      {changed(gain, gain + slots + "[]"), finger + "\"gains\" must be 1 to 2048 numbers"},
      {changed(gain, gain + R"(, "gains": [1])"), finger + "\"slot_s\" is missing"},
      {changed(gain, gain + R"(, "slot_s": 0, "gains": [1])"), finger + "\"slot_s\" must be"},
      {changed(gain, gain + R"(, "slot_s": 0.003, "gains": [1])"), finger + "its gains are for slots of another"},
      {first + R"(, {"slot": 999999, "time_s": 6, "fingers": []})", "frame 1"},
      {"", "no frame"}};
  for (const auto& [frames, part] : wrong)
    expect_failure(play(frames), 4, part);
}

}  // namespace
}  // namespace palpa::test
