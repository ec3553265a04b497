// The live loop: its messages, its data, and that it always ends in silence. Where signals, disks and limits matter, it
// is the real program. And the line in which it shows its state on a terminal.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "cli/run_line.hpp"
#include "cli/support/boxes.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "support/begins.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/thrown.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

std::string cube() {
  return source_file("assets/cube.glb").string();
}

bool sounds(const RecordedDrive& recorded) {
  return loudest(recorded.drive) > 0;
}

TEST(CliRun, MeasuresItselfAndRecordsDrivesThatEndInSilence) {
  const auto folder = scratch_folder("run");
  const Result result = succeeded(palpa({"run", "--scene", cube(), "--frames", "60", "--hold", "500ms", "--link",
                                         "record:" + (folder / "d.bin").string(), "--stats", "json"}));
  EXPECT_EQ(result.err_without_lateness(), "");
  const json stats = json::parse(result.out);
  EXPECT_EQ(stats["frames"]["captured"], 60);
  EXPECT_GT(stats["frames"]["touching"], 0);
  EXPECT_GT(stats["timing_ms"]["frame_to_plan"]["median"], 0);
  for (const char* pass : {"skin count", "clusters", "foci", "drives"})
    EXPECT_TRUE(stats["passes_ms"].contains(pass)) << pass;

  const DriveRecording recording = read_to_silence(folder / "d.bin");
  EXPECT_EQ(recording.transducers, 3984u);
  EXPECT_EQ(recording.slot_s, 1.5e-3);
  ASSERT_GT(recording.drives.size(), 10u);
  EXPECT_TRUE(std::ranges::any_of(recording.drives, sounds));
  for (std::size_t i = 1; i < recording.drives.size(); ++i) {
    ASSERT_GT(recording.drives[i].slot, recording.drives[i - 1].slot);
  }
}

/// A driver that compiles every shader takes half a minute, and minutes on a busy machine.
constexpr double patience_s = 400;

/// palpa run on a disk of `size`, where everything is that it writes: what is asked for, and the caches of palpa and
/// the driver. Exit code 77: no mounts of one's own are allowed here.
Result on_small_disk(const std::filesystem::path& disk, const std::string& size,
                     const std::vector<std::string>& options) {
  std::filesystem::create_directories(disk);
  const std::string script = "mount -t tmpfs -o size=" + size +
                             " full \"$1\" || exit 77; export HOME=\"$1\" XDG_CACHE_HOME=\"$1\" "
                             "MESA_SHADER_CACHE_DIR=\"$1\" TMPDIR=\"$1\"; shift; exec \"$@\"";
  std::vector<std::string> arguments{"--mount",      "/bin/sh", "-c",      script, "sh",       disk.string(),
                                     palpa_binary(), "run",     "--scene", cube(), "--frames", "60"};
  if (geteuid() != 0) arguments.insert(arguments.begin(), "--map-root-user");
  Result result = run_program("/usr/bin/unshare", with(arguments, options),
                              {.environment = {where_assets_are()}, .timeout_s = patience_s});
  if (result.err.find("unshare") != std::string::npos) result.exit_code = 77;
  return result;
}

// The driver finds none of its shaders in the cache and cannot keep those that it compiles: the disk is full.
TEST(CliRun, SoundsFromTheFirstFramesAlsoWhereNoShaderHasBeenCompiledBefore) {
  if (instrumented()) GTEST_SKIP() << "skipped: half a minute in the driver's compiler, which is not instrumented";
  const auto folder = scratch_folder("cold");
  const std::vector<std::string> options =
      with(small_frames(), {"--link", "record:" + (folder / "d.bin").string(), "--stats", "json", "--log-level", "info",
                            "--hold", "2s"});  // less than a compiler takes
  Result result = on_small_disk(folder / "disk", "400k", options);
  if (result.exit_code == 77) {
    result = palpa(with({"run", "--scene", cube(), "--frames", "60"}, options),
                   {.environment = {{"MESA_SHADER_CACHE_DISABLE", "true"}}, .timeout_s = patience_s});
  }
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("compiling shaders"), std::string::npos) << "users do not learn what they wait for";
  // The source is real time: frames that wait for a compiler are replaced, and what is planned for them comes too late.
  EXPECT_GT(json::parse(result.out)["frames"]["planned"], 0);
  EXPECT_TRUE(std::ranges::any_of(read_to_silence(folder / "d.bin").drives, sounds));
}

/// Waits until so many more bytes than `before` are in the file that a run records its drives in.
bool grows(const std::filesystem::path& drives, std::uintmax_t before, std::uintmax_t by) {
  return begins([&] {
    std::error_code none;
    const auto size = std::filesystem::file_size(drives, none);
    return !none && size > before + by;
  });
}

/// Sends signals to a run that sounds, at least so many bytes of drives after its start. It must end in silence.
void expect_silent_end(const std::vector<std::string>& options, const std::vector<int>& signals,
                       std::uintmax_t least_bytes = 4'000'000) {
  static std::atomic<int> runs{0};
  const auto file = scratch_folder("run-signals-" + std::to_string(runs++)) / "drives";
  LiveRun run(with(with({"--scene", cube(), "--quiet", "--link", "record:" + file.string()}, small_frames()), options));
  ASSERT_TRUE(grows(file, 0, least_bytes)) << file << " stays short";
  for (const int signal : signals) {
    const auto before = std::filesystem::file_size(file);
    run.signal(signal);
    run.signal(signal);  // impatience changes nothing
    if (signal != signals.back()) {
      EXPECT_TRUE(grows(file, before, 1'000'000)) << "signal " << signal << " ends it";
    }
  }
  const LiveRun::End end = run.wait(60);
  EXPECT_TRUE(end.in_order()) << "signal " << signals.front() << ": " << end.exit_code << ' ' << end.by_signal;
  read_to_silence(file);
}

TEST(CliRun, SignalsEndItInSilence) {
  // Those that people and terminals send. driver/guard/test_signals_run.cpp has every signal.
  std::vector<std::pair<std::string, std::vector<int>>> all{{"gpu", {SIGINT}}, {"gpu", {SIGTERM}}};
  for (const int signal : {SIGHUP, SIGQUIT, SIGTSTP})
    all.emplace_back("cpu", std::vector{signal});
  all.emplace_back("cpu", std::vector{SIGTTOU, SIGTTIN, SIGTERM});  // a terminal stops nothing in the background
  side_by_side(3, all, [](const auto& one) { expect_silent_end({"--backend", one.first}, one.second); });
}

TEST(CliRun, SignalsEndItInTimeHoweverLongItsSlotsAndItsRamp) {
  const auto while_it_ramps = [] { expect_silent_end({"--backend", "cpu", "--ramp", "500ms"}, {SIGTERM}); };
  // The second drive has just left. Waiting for the end of its slot would exceed the one second that palpa may take.
  const auto within_a_slot = [] { expect_silent_end({"--backend", "cpu", "--dwell", "1.5s"}, {SIGTERM}, 50'000); };
  side_by_side({while_it_ramps, within_a_slot});
}

TEST(CliRun, ACeilingMultipliesAmplitudesAndGains) {
  const auto file = scratch_folder("ceiling") / "d.bin";
  const std::vector<std::string> options =
      with({"--frames", "30", "--every-frame", "--hold", "1s", "--ceiling", "0.25"}, small_frames());
  const auto play_to = [&](const std::string& link) {
    succeeded(palpa_here(with({"run", "--scene", cube(), "--quiet", "--link", link}, options)));
  };
  play_to("record:" + file.string());
  float most = 0;
  for (const auto& sent : read_to_silence(file).drives)
    most = std::max(most, loudest(sent.drive));
  EXPECT_EQ(most, 0.25F) << "a drive's largest amplitude is 1 without a ceiling";

  const UdpReceiver receiver(std::chrono::milliseconds(50));  // who sends has ended before anybody looks
  play_to("foci:" + receiver.address());
  std::vector<json> lines;
  for (std::string text; !(text = receiver.next()).empty();)
    lines.push_back(json::parse(text));
  ASSERT_GT(lines.size(), 5u);
  EXPECT_TRUE(lines.back()["fingers"].empty());
  const auto first = std::ranges::find_if(lines, [](const json& line) { return !line["fingers"].empty(); });
  ASSERT_NE(first, lines.end());
  const json finger = (*first)["fingers"][0];
  EXPECT_EQ(finger["gain"], 0.25);
  EXPECT_EQ(finger["solid"], "cube");
  EXPECT_EQ(finger["foci_m"].size(), 10u);
  EXPECT_EQ(finger["order"], (std::vector<int>{0, 3, 6, 9, 2, 5, 8, 1, 4, 7}));
  EXPECT_LT(std::abs(finger["foci_m"][0][1].get<double>()), 0.006) << "foci lie near the cube's top";
}

TEST(CliRun, ARampTakesAmplitudesUpAndDown) {
  const auto file = scratch_folder("ramp") / "d.bin";
  succeeded(palpa_here(with({"run", "--scene", cube(), "--frames", "60", "--every-frame", "--hold", "1s", "--ramp",
                             "6ms", "--link", "record:" + file.string()},
                            small_frames())));
  float last = 0, most = 0;
  for (const auto& sent : read_to_silence(file).drives) {
    const float loud = loudest(sent.drive);
    EXPECT_LT(std::abs(loud - last), 0.26F) << "slot " << sent.slot << ": a ramp of four slots";
    most = std::max(most, loud);
    last = loud;
  }
  EXPECT_EQ(most, 1.0F);
}

TEST(CliRun, AFullDiskIsAnErrorAndStillSilence) {
  const auto folder = scratch_folder("full");
  const auto fails = [&](const char* size, const char* option, const std::string& value) {
    return on_small_disk(folder / "disk", size, {"--backend", "cpu", "--quiet", option, value});
  };
  const std::string output = (folder / "disk" / "output").string();
  const Result link = fails("400k", "--link", "record:" + output);
  if (link.exit_code == 77) GTEST_SKIP() << "skipped: no mounts of one's own are allowed here: " << link.err;
  expect_failure(link, 1, "output: cannot be written: No space left on device");
  expect_failure(fails("40k", "--record", output), 1, "cannot be written: No space left on device");
}

// `ulimit -f`. From version 24 on, Mesa's software device keeps its memory in a file without a name, and crashes if
// that file cannot grow.
TEST(CliRun, AFileThatMayNotGrowIsAnErrorAndStillSilence) {
  const auto folder = scratch_folder("file-limit");
  const auto fails = [&](const std::string& blocks, const std::string& output) {
    const std::string shell =
        "ulimit -f " + blocks + "; exec \"$0\" run --scene \"$1\" --frames 60 --quiet " + output + "\"$2\"";
    const Result result = run_program("/bin/bash", {"-c", shell, palpa_binary(), cube(), (folder / blocks).string()},
                                      {{where_assets_are()}});
    const bool file = result.err.find("cannot be written: File too large") != std::string::npos;
    expect_failure(result, 1, file ? "cannot be written" : "ulimit -f");
    if (file && output.ends_with("record:")) read_to_silence(folder / blocks);
  };
  side_by_side({[&] { fails("400", "--link record:"); }, [&] { fails("4", "--backend cpu --record "); }});
}

TEST(CliRun, AnOverloadedLoopSaysSo) {
  const auto folder = scratch_folder("overload");
  const std::string scene = (folder / "box.glb").string(), take = (folder / "take").string();
  // A whole hand in the box: far more skin than a fingertip's. The recording run needs to touch only a fingertip. The
  // box also reaches into the boards, whose points count here.
  write_boxes(scene, {{"box", Vec3(0, 0.1, 0), Vec3(0, 1, 0), Vec3(1, 0, 0), 0.2, 0.2, 0.4}});
  succeeded(
      palpa_here({"run", "--scene", cube(), "--source", "synthetic:" + source_file("assets/hand.glb").string(),
                  "--backend", "cpu", "--frames", "5", "--every-frame", "--noise-free", "--record", take, "--quiet"}));
  const Result late =
      succeeded(palpa_here({"run", "--scene", scene, "--source", "recording:" + take, "--every-frame", "--cluster",
                            "inside", "--keep-boards", "--hold", "1ms", "--stats", "json"}));
  EXPECT_EQ(late.err_without_lateness(), "");
  EXPECT_NE(late.err.find("palpa: warning: overloaded: the time from frame to drives is"), std::string::npos)
      << late.err;
  EXPECT_NE(late.err.find("longer than the hold of 1 ms"), std::string::npos) << late.err;
}

// docs/solvers.md, "On fingers that move".
TEST(CliRun, ComputesFociOnTheFingersThatTouch) {
  const Result result = succeeded(palpa_here({"run", "--scene", cube(), "--layout", "openmpd", "--backend", "cpu",
                                              "--frames", "270", "--transfer", "finger", "--stats", "json"}));
  const json transfer = json::parse(result.out)["transfer"];
  EXPECT_GE(transfer["touching"], 1);
  EXPECT_LE(transfer["frames"], transfer["touching"]);
  EXPECT_EQ(transfer["took_ms"]["count"], transfer["answers"].get<int>() + transfer["not_found"].get<int>());
  // On a busy machine, no answer may come in these seconds.
  if (transfer["answers"] > 0) {
    EXPECT_GE(transfer["gain"]["least"], 0.95);
    EXPECT_LE(transfer["gain"]["median"], 3.0);
  }
}

TEST(CliBench, ChecksThenMeasures) {
  const auto folder = scratch_folder("bench");
  succeeded(palpa_here({"bench", "--runs", "3", "--suite", "loop", "--csv", (folder / "b.csv").string(), "--json",
                        (folder / "b.json").string()}));
  const json document = json::parse(read_text(folder / "b.json"));
  EXPECT_GT(document["peak_resident_bytes"], 0);
  std::ifstream csv(folder / "b.csv");
  std::string header, line;
  std::getline(csv, header);
  EXPECT_EQ(header, "suite,case,stage,median_ms,p99_ms,min_ms,runs,value,unit,note,device,driver");
  int totals = 0, splits_of_host = 0;
  std::size_t number = 0;
  while (std::getline(csv, line)) {
    const json& row = document["rows"].at(number++);
    const double least = row["min_ms"], median = row["median_ms"], p99 = row["p99_ms"];
    EXPECT_GT(least, 0);
    EXPECT_LE(least, median);
    EXPECT_LE(median, p99);
    EXPECT_CONTAINS(line, fmt::format(",{:.5g},{:.5g},{:.5g},{},", median, p99, least, row["runs"].get<int>()));
    totals += line.find(",total,") != std::string::npos ? 1 : 0;
    splits_of_host += line.find(R"(, host",split,)") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(totals, 6) << "each case on the device and on the host";
  EXPECT_EQ(splits_of_host, 3);
}

TEST(CliBench, MeasuresWhatLinksCost) {
  const Result result = succeeded(palpa({"bench", "--runs", "3", "--suite", "links", "--json", "-"}));
  const json rows = json::parse(result.out)["rows"];
  ASSERT_EQ(rows.size(), 2u) << rows;
  EXPECT_EQ(rows[0]["stage"], "encode");
  EXPECT_EQ(rows[0]["runs"], 1000);
  EXPECT_GT(rows[0]["value"], 0) << "% of a core";
  EXPECT_EQ(rows[1]["stage"], "drive to wire");
  EXPECT_GT(rows[1]["p99_ms"], 0);
  // A board encodes what it sends, which takes nearly all of the time. The encoding that is measured alone is not in
  // it.
  if (!instrumented()) {
    EXPECT_LT(rows[1]["min_ms"].get<double>(), 1.6 * rows[0]["min_ms"].get<double>());
  }
}

using cli::run_line;
using cli::RunState;

TEST(RunLine, SaysWhatHappens) {
  RunState state{.link = "openmpd:A", .frames = 45, .rate_hz = 89.8, .latency_s = 4.24e-3, .fingers = 2};
  state.depth_m = 1.42e-3;
  state.sounds = true;
  EXPECT_EQ(run_line(state, 100),
            "SOUNDING on openmpd:A | 2 fingers, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops");
  state.sounds = false;
  state.fingers = 1;
  state.of = 90;
  EXPECT_EQ(run_line(state, 100),
            "silent on openmpd:A | 1 finger, 1.4 mm deep | 45 of 90 frames, 90/s, 4.2 ms | Ctrl-C stops");
  state.stuck = true;
  EXPECT_CONTAINS(run_line(state, 140), "MAY SOUND on openmpd:A, which takes no drives | 1 finger");
  state.stuck = false;
  state.fingers = 0;
  state.rate_hz = 0;
  state.of = 0;
  state.link = "null";
  EXPECT_EQ(run_line(state, 100), "silent on null (no array) | no touch | no frames now | Ctrl-C stops");
  state.to_be_recorded = 3;
  EXPECT_EQ(run_line(state, 100), "silent | writing the recording: 3 frames left | Ctrl-C stops");
}

TEST(RunLine, FitsIntoTheTerminal) {
  RunState usual{.link = "null", .frames = 45, .rate_hz = 89.8, .latency_s = 4.24e-3, .fingers = 1};
  usual.depth_m = 1.42e-3;
  usual.sounds = true;
  EXPECT_EQ(run_line(usual, 100),
            "SOUNDING on null (no array) | 1 finger, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops");
  EXPECT_EQ(run_line(usual, 79), "SOUNDING on null | 1 finger, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops");
  RunState board{.link = "openmpd:EMU1", .frames = 45, .of = 300, .rate_hz = 89.8, .latency_s = 4.24e-3, .fingers = 2};
  board.depth_m = 1.42e-3;
  board.sounds = true;
  EXPECT_EQ(run_line(board, 85), "SOUNDING on openmpd:EMU1 | 2 fingers, 1.4 mm | 45/300, 90/s, 4.2 ms | Ctrl-C stops");
  EXPECT_EQ(run_line(board, 70), "SOUNDING | 2 fingers, 1.4 mm | 45/300, 90/s, 4.2 ms | Ctrl-C stops");
  RunState state{.link = std::string(300, 'x') + "\x1b[2J", .frames = 1, .rate_hz = 90, .fingers = 64};
  state.of = 1'000'000;
  EXPECT_EQ(run_line(state, 20).size(), 20u);
  EXPECT_EQ(run_line(state, 0), "");
  EXPECT_EQ(run_line(state, 300).find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace palpa::test
