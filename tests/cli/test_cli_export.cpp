// `palpa export`: a recording's foci, events and drives on its own clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <fstream>
#include <sstream>

#include "array/drive.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "driver/cameras/made_up_bag.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "session/links/record_link.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"
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

  std::string in(const std::string& name) const { return (folder / name).string(); }

  static std::filesystem::path recorded() {
    const auto take = scratch_folder("take") / "take";
    EXPECT_EQ(palpa({"run", "--scene", source_file("assets/cube.glb").string(), "--frames", "12", "--every-frame",
                     "--backend", "cpu", "--record", take.string(), "--quiet"})
                  .exit_code,
              0);
    return take;
  }

  /// 12 frames of the synthetic finger; frames from `whole` on are `later_s` seconds later.
  std::string take(std::size_t whole = 12, double later_s = 0) {
    static const std::filesystem::path made = recorded();
    const std::string take = in("take");
    std::filesystem::copy(made, take);
    std::ifstream file(take + "/times.csv");
    std::string line, text;
    std::getline(file, text);
    text += '\n';
    times.clear();
    while (std::getline(file, line)) {
      std::istringstream cells(line);
      std::string cell;
      std::getline(cells, cell, ',');
      text += cell;
      const double late = times.size() < whole ? 0 : later_s;
      double oldest = 1e9;
      while (std::getline(cells, cell, ',')) {
        std::ostringstream time;
        time.precision(17);
        time << std::stod(cell) + late;
        text += ',' + time.str();
        oldest = std::min(oldest, std::stod(time.str()));
      }
      text += '\n';
      times.push_back(oldest);
    }
    file.close();
    std::ofstream(take + "/times.csv") << text;
    return "recording:" + take;
  }
  /// On the processor: TheSameBytesEachTimeAndOnBothBackends shows that the backend makes no difference.
  Result exported(const std::string& source, const std::vector<std::string>& outputs) const {
    return palpa_here(with(line_of(source), with(outputs, {"--backend", "cpu"})));
  }
  std::vector<std::string> line_of(const std::string& source) const {
    return {"export", "--scene", cube, "--source", source};
  }
  std::uint64_t slot_of(double time_s) const {
    return static_cast<std::uint64_t>(std::ceil((time_s - times.front()) / slot_s - 1e-6));
  }

  std::vector<double> times;  ///< of the frames
};

bool silent(const array::Drive& drive) {
  return std::all_of(drive.begin(), drive.end(), [](const auto& t) { return t.amplitude == 0; });
}

TEST_F(CliExport, TheSameBytesEachTimeAndOnBothBackends) {
  const std::string source = take();
  const std::vector<std::string> names{"f.csv", "f.json", "e.jsonl", "d.bin"};
  std::vector<std::vector<std::string>> all;
  for (const std::string backend : {"gpu", "gpu", "cpu"}) {
    const std::vector<std::string> line = with(line_of(source), {"--backend", backend, "--quiet"});
    const std::vector<std::string> files{"--foci", in("f.csv"), "--events", in("e.jsonl"), "--drives", in("d.bin")};
    ASSERT_EQ(palpa(with(line, files)).exit_code, 0);
    ASSERT_EQ(palpa_here(with(line, {"--foci", in("f.json")})).exit_code, 0);
    std::vector<std::string>& contents = all.emplace_back();
    for (const std::string& name : names)
      contents.push_back(read_text(in(name)));
  }
  for (std::size_t n = 0; n < names.size(); ++n) {
    EXPECT_GT(all[0][n].size(), 500u) << names[n];
    EXPECT_TRUE(all[0][n] == all[1][n]) << names[n];
    // Drives of both are within rounding of each other, not the same.
    if (names[n] == "d.bin") continue;
    EXPECT_TRUE(all[0][n] == all[2][n]) << names[n];
  }
}

TEST_F(CliExport, EachSlotPlaysTheNewestFrameByThen) {
  const Result result =
      palpa(with(line_of(take()), {"--foci", in("f.json"), "--drives", in("d.bin"), "--json", in("s.json")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("12 frames, 12 with a touch; ")) << result.out;
  const json foci = json::parse(read_text(in("f.json")));
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

  const session::DriveRecording recording = session::read_drive_recording(in("d.bin"));
  ASSERT_EQ(recording.drives.size(), end + 1);
  const array::Layout layout = setup::load_posed_rig({}).layout;
  std::size_t frame = 0;
  for (std::uint64_t slot = 0; slot < end; ++slot) {
    while (frame + 1 < times.size() && slot >= slot_of(times[frame + 1]))
      ++frame;
    const session::RecordedDrive& played = recording.drives[slot];
    ASSERT_EQ(played.slot, slot);
    const json& finger = frames[frame]["fingers"][0];
    const json& order = finger["order"];
    const json& at = finger["foci_m"][order[slot % order.size()].get<std::size_t>()];
    const array::SlotFocus focus{Vec3(at[0], at[1], at[2]), 1};
    array::Drive wanted(layout.transducers.size());
    array::drive_for(layout, std::span(&focus, 1), setup::drive_options({}), wanted);
    for (std::size_t t = 0; t < wanted.size(); t += 97) {
      ASSERT_NEAR(played.drive[t].amplitude, wanted[t].amplitude, 1e-5) << slot;
      ASSERT_LT(std::abs(std::remainder(played.drive[t].phase - wanted[t].phase, 2 * 3.14159265358979)), 1e-3) << slot;
    }
  }
  EXPECT_TRUE(silent(recording.drives.back().drive));
  const json stats = json::parse(read_text(in("s.json")));
  EXPECT_EQ(stats["drives"], end);
  EXPECT_EQ(stats["silent_drives"], 0);
}

TEST_F(CliExport, WhereNoFrameCameThereIsSilence) {
  const Result result =
      exported(take(6, 0.3), {"--drives", in("d.bin"), "--events", in("e.jsonl"), "--foci", in("f.csv"), "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const session::DriveRecording recording = session::read_drive_recording(in("d.bin"));
  const std::uint64_t from = slot_of(times[5] + hold_s), until = slot_of(times[6]);
  ASSERT_GT(until, from + 100);
  for (const session::RecordedDrive& played : recording.drives) {
    const bool gap = played.slot >= from && played.slot < until;
    EXPECT_EQ(silent(played.drive), gap || played.slot == recording.drives.back().slot) << played.slot;
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
  const Result result = exported(take(6, 1e6), {"--layout", "openmpd", "--drives", in("d.bin"), "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const session::DriveRecording recording = session::read_drive_recording(in("d.bin"));
  EXPECT_LT(recording.drives.size(), 7500u) << "ten seconds of silence and what sounds";
  const std::uint64_t until = slot_of(times[6]);
  const auto again = std::find_if(recording.drives.begin(), recording.drives.end(),
                                  [&](const auto& played) { return played.slot == until; });
  ASSERT_NE(again, recording.drives.end());
  EXPECT_FALSE(silent(again->drive));
  EXPECT_TRUE(silent(std::prev(again)->drive));
}

TEST_F(CliExport, AShortDwellMakesAPauseNoLonger) {
  ASSERT_EQ(exported(take(6, 3), {"--dwell", "100us", "--events", in("e.jsonl"), "--json", in("s.json"), "--quiet"})
                .exit_code,
            0);
  const json stats = json::parse(read_text(in("s.json")));
  EXPECT_EQ(stats["silent_drives"], 10'000) << "of three seconds";
  EXPECT_GT(stats["drives"], 12'000);
}

TEST_F(CliExport, ARampIsThereToItsEnd) {
  ASSERT_EQ(exported(take(), {"--drives", in("d.bin"), "--ramp", "15ms", "--quiet"}).exit_code, 0);
  const session::DriveRecording recording = session::read_drive_recording(in("d.bin"));
  float last = 0;
  for (const session::RecordedDrive& played : recording.drives) {
    float loud = 0;
    for (const auto& t : played.drive)
      loud = std::max(loud, t.amplitude);
    EXPECT_LT(std::abs(loud - last), 0.11F) << played.slot << ": a ramp of ten slots";
    last = loud;
  }
  EXPECT_EQ(last, 0);
}

TEST_F(CliExport, WhatCannotBeFinishedReplacesNothing) {
  const std::string source = take();
  write_text(in("f.csv"), "of before");
  std::filesystem::resize_file(in("take/000008-0.png"), 30);
  const Result result = exported(source, {"--foci", in("f.csv"), "--events", in("e.jsonl"), "--quiet"});
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_EQ(read_text(in("f.csv")), "of before");
  const std::string events = read_text(in("e.jsonl"));
  EXPECT_NE(events.find("\"release\""), std::string::npos) << "who touches lets go: " << events;
  EXPECT_TRUE(events.ends_with("}\n"));
}

TEST_F(CliExport, APressureThatIsNotReachedIsToldOnce) {
  const Result result = exported(take(), {"--foci", in("f.csv"), "--pressure", "90kPa", "--json", in("s.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err_lines().size(), 1u) << result.err;
  EXPECT_NE(result.out.find("of the 90000 Pa asked for"), std::string::npos) << result.out;
  EXPECT_EQ(json::parse(read_text(in("s.json")))["fingers"][0]["asked_pa"], 90000);
}

TEST_F(CliExport, FociAsATable) {
  ASSERT_EQ(exported(take(), {"--foci", in("f.csv"), "--foci-count", "6", "--quiet"}).exit_code, 0);
  std::istringstream table(read_text(in("f.csv")));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "slot,time_s,finger,solid,focus,x,y,z,gain");
  std::size_t rows = 0;
  for (; std::getline(table, line); ++rows)
    EXPECT_NE(line.find(",0,cube," + std::to_string(rows % 6) + ","), std::string::npos) << line;
  EXPECT_EQ(rows, times.size() * 6);
}

TEST_F(CliExport, ABagEndsByItselfToo) {
  const driver::rosbag::test::MadeUpBag bag;
  const auto bytes = bag.bytes();
  std::ofstream(in("take.bag"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const Result result = exported("bag:" + in("take.bag"), {"--foci", in("f.json"), "--json", in("all.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(read_text(in("all.json")))["frames"], bag.times_s.size());
}

TEST_F(CliExport, FociThatWerePlayedHaveTheSameDrivesAgain) {
  const std::string source = take(6, 0.5);  // with a pause
  struct Case {
    std::vector<std::string> options, again;
    double tolerance;  ///< of amplitudes; 0: the same bytes
  };
  const Case cases[] = {{{}, {}, 0},
                        {{"--method", "multi-focus", "--solver", "gs-pat"}, {"--solver", "gs-pat"}, 0},
                        {{"--method", "single-focus"}, {}, 0},
                        {{"--foci-count", "7", "--dwell", "2ms"}, {}, 0},
                        {{"--ceiling", "0.5"}, {}, 1e-6},
                        {{"--pressure", "2kPa"}, {}, 1e-3}};
  for (const auto& [options, again, tolerance] : cases) {
    SCOPED_TRACE(testing::PrintToString(options));
    ASSERT_EQ(exported(source, with(options, {"--foci", in("f.json"), "--drives", in("d.bin"), "--quiet"})).exit_code,
              0);
    const Result result =
        palpa_here(with({"export", "--played", in("f.json"), "--drives", in("again.bin"), "--quiet"}, again));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    if (tolerance == 0) {
      EXPECT_TRUE(read_text(in("d.bin")) == read_text(in("again.bin")));
      continue;
    }
    const session::DriveRecording first = session::read_drive_recording(in("d.bin")),
                                  second = session::read_drive_recording(in("again.bin"));
    ASSERT_EQ(second.drives.size(), first.drives.size());
    double farthest = 0;
    for (std::size_t n = 0; n < first.drives.size(); ++n) {
      ASSERT_EQ(second.drives[n].slot, first.drives[n].slot);
      for (std::size_t k = 0; k < first.transducers; ++k) {
        const array::TransducerDrive &a = first.drives[n].drive[k], &b = second.drives[n].drive[k];
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
    ASSERT_EQ(
        exported(source, {"--method", method, "--foci", in("f.json"), "--drives", in("d.bin"), "--quiet"}).exit_code,
        0);
    EXPECT_CONTAINS(read_text(in("f.json")), "\"gains\":");
    ASSERT_EQ(palpa_here({"export", "--played", in("f.json"), "--drives", in("again.bin"), "--quiet"}).exit_code, 0);
    EXPECT_TRUE(read_text(in("d.bin")) == read_text(in("again.bin"))) << method;
  }
}

TEST_F(CliExport, PlayedFociOfAnyFormAreReadOrRefusedWithTheirPlace) {
  const auto frames = [&](const std::string& text) {
    std::ofstream(in("f.json")) << R"({"slot_s": 0.0015, "frames": [)" << text << "]}";
    return palpa_here({"export", "--played", in("f.json"), "--layout", "openmpd", "--drives", in("d.bin"), "--json",
                       in("s.json"), "--quiet"});
  };
  const std::string finger = R"({"id": 3, "solid": "cube", "foci_m": [[0, 0.15, 0], [0.01, 0.15, 0]], "order": [1, 0],
      "dwell_s": 0.0015, "modulation_hz": 0, "gain": 0.5})";
  const std::string first = R"({"slot": 1000000, "time_s": 5, "fingers": [)" + finger + "]}";
  ASSERT_EQ(frames(first).exit_code, 0);
  // The last frame sounds for the hold; the first slot is that of the file.
  const session::DriveRecording recording = session::read_drive_recording(in("d.bin"));
  EXPECT_EQ(recording.drives.size(), 68u);
  EXPECT_EQ(recording.drives.front().slot, 1000000u);
  EXPECT_TRUE(silent(recording.drives.back().drive));
  EXPECT_FALSE(silent(recording.drives[66].drive));
  EXPECT_EQ(json::parse(read_text(in("s.json")))["drives"], 67);

  const auto changed = [&](const std::string& part, const std::string& by) {
    std::string text = first;
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return text.replace(at, part.size(), by);
  };
  const std::string frame = "f.json: frame 0", its_finger = "frame 0, finger 0: ";
  expect_failure(frames(changed("1000000", "-1")), 4, frame);
  expect_failure(frames(changed("\"slot\"", "\"slat\"")), 4, frame);
  expect_failure(frames(changed("[1, 0]", "[1, 2]")), 4, its_finger + "its order plays focus 2 of 2 foci");
  expect_failure(frames(changed("[1, 0]", "[[1, 0], [1]]")), 4, its_finger + "the lists in");
  expect_failure(frames(changed("[0, 0.15, 0]", "[0, null, 0]")), 4, its_finger + "\"foci_m\"");
  expect_failure(frames(changed("[0, 0.15, 0]", "null")), 4, its_finger + "\"foci_m\"");
  expect_failure(frames(changed("0.5", "1.5")), 4, its_finger + "\"gain\"");
  expect_failure(frames(changed("0.0015", "0.0001")), 4, its_finger + "\"dwell_s\"");
  expect_failure(frames(changed(R"("modulation_hz": 0)", R"("modulation_hz": 200, "modulation": "triangle")")), 4,
                 its_finger + "\"modulation\"");
  const auto with_gains = [&](const std::string& gains, const std::string& slot = R"("slot_s": 0.0015, )") {
    return frames(changed(R"("gain": 0.5)", R"("gain": 0.5, )" + slot + R"("gains": )" + gains));
  };
  expect_failure(with_gains("[0.5, 2]"), 4, its_finger + "\"gains\"");
  expect_failure(with_gains("1"), 4, its_finger);
  expect_failure(with_gains("[]"), 4, its_finger + "\"gains\" must be 1 to 2048 numbers");
  expect_failure(with_gains("[1]", ""), 4, its_finger + "\"slot_s\" is missing");
  expect_failure(with_gains("[1]", R"("slot_s": 0, )"), 4, its_finger + "\"slot_s\" must be");
  expect_failure(with_gains("[1]", R"("slot_s": 0.003, )"), 4, its_finger + "its gains are for slots of another");
  // Gains that change begin with the frame's slot, and the last one stays.
  ASSERT_EQ(with_gains("[1, 0, 0.5]").exit_code, 0);
  const session::DriveRecording changing = session::read_drive_recording(in("d.bin"));
  ASSERT_EQ(changing.drives.size(), 68u);
  EXPECT_EQ(changing.drives[0].drive[7].amplitude, recording.drives[0].drive[7].amplitude);
  EXPECT_TRUE(silent(changing.drives[1].drive));
  EXPECT_NEAR(changing.drives[40].drive[7].amplitude, 0.5F * recording.drives[40].drive[7].amplitude, 1e-6);
  expect_failure(frames(first + R"(, {"slot": 999999, "time_s": 6, "fingers": []})"), 4, "frame 1");
  expect_failure(frames(""), 4, "no frame");
  std::ofstream(in("f.json")) << R"({"fingers": []})";
  expect_failure(palpa_here({"export", "--played", in("f.json"), "--drives", in("d.bin")}), 4, "not a file of foci");
  expect_failure(palpa_here({"export", "--played", in("f.json")}), 2, "--played goes with --drives");
  expect_failure(palpa_here({"export", "--played", in("f.json"), "--scene", cube, "--drives", in("d.bin")}), 2,
                 "--scene has no effect with --played");
  expect_failure(palpa_here({"export", "--played", in("f.json"), "--drives", in("f.json")}), 2, "--drives");
}

TEST_F(CliExport, WhatCannotBeExportedIsRefused) {
  expect_failure(palpa_here({"export", "--scene", cube, "--frames", "2"}), 2, "give --foci, --events or --drives");
  expect_failure(palpa_here({"export", "--scene", cube, "--foci", in("f.csv")}), 2, "does not end: give --frames");
  expect_failure(palpa_here({"export", "--scene", cube, "--frames", "2", "--foci", in("f.txt")}), 2, ".csv or .json");
  expect_failure(
      palpa_here({"export", "--scene", cube, "--frames", "2", "--foci", in("x.csv"), "--drives", in("x.csv")}), 2,
      "--drives");
  expect_failure(palpa_here({"export", "--frames", "2", "--foci", in("f.csv")}), 2, "--scene is missing");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace palpa::test
