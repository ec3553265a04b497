// `palpa run` with `palpa emulate openmpd`: the real programs, with a socket between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/openmpd/emulation.hpp"
#include "driver/openmpd/openmpd_files.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
namespace openmpd = driver::openmpd;

std::vector<std::string> run_to(const std::string& link, const std::string& layout) {
  return with({"--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--hold", "500ms",
               "--layout", layout, "--link", link},
              small_frames());
}

TEST(OpenMpdRun, TwoBoardsHearALoopToItsSilentEnd) {
  Emulation emulation("openmpd-run", "EMU1,EMU2", {"--trace", "-"});
  write_text(emulation.folder() / "board_1.pat", board_file_text("EMU1", made_up_calibration(1)));
  const RunOptions options{.environment = emulation.environment()};
  const Result result =
      succeeded(palpa(with(with({"run"}, run_to("openmpd:EMU1,EMU2", "openmpd-pair")),
                           {"--frames", "30", "--json", "-", "--board-files", emulation.folder().string()}),
                      options));
  EXPECT_CONTAINS(result.err, "no file in");
  // In addition to any real boards.
  const Result doctor = palpa({"doctor", "--json", "-"}, options);
  const json seen = json::parse(doctor.out)["boards"];
  EXPECT_TRUE(std::any_of(seen.begin(), seen.end(), [](const json& board) {
    return board["serial"] == "EMU2" && board["place"] == "emulated-2" && board["usable"];
  })) << seen;
  const json report = emulation.end();
  ASSERT_EQ(report["boards"].size(), 2u);
  for (const json& board : report["boards"]) {
    EXPECT_EQ(board["violation_count"], 0) << board;
    EXPECT_FALSE(board["sounds"].get<bool>());
    EXPECT_EQ(board["divider"], 4);
    EXPECT_EQ(board["frames"], report["boards"][0]["frames"]);
    // Drives that a busy computer leaves out are never sent late.
    EXPECT_GT(board["frames"].get<std::uint64_t>(), 20u);
  }
}

TEST(OpenMpdRun, WithoutALayoutItIsThatOfTheLinksOwnBoards) {
  Emulation emulation("openmpd-own-layout", "EMU1,EMU2,EMU3");
  const RunOptions options{.environment = emulation.environment()};
  const auto run = [&](const std::string& link, const std::filesystem::path& rig) {
    return palpa({"run", "--scene", source_file("assets/cube.glb").string(), "--frames", "3", "--link", link,
                  "--log-level", "info", "--backend", "cpu", "--rig", rig.string()},
                 options);
  };
  const auto paper = source_file("assets/rigs/paper.toml"), cameras = emulation.folder() / "rig.toml";
  const std::string text = read_text(paper);
  write_text(cameras, text.substr(0, text.find("[array]")));
  const auto beside_a_rig = [&] {
    const Result two = succeeded(run("openmpd:EMU1,EMU2", cameras));
    EXPECT_CONTAINS(two.err, "--link openmpd:EMU1,EMU2: palpa uses the link's own array, --layout openmpd-pair,");
    EXPECT_CONTAINS(two.err, "nor " + cameras.string() + " names one");
    // A rig that names an array takes precedence over the link.
    const Result named = run("openmpd:EMU1", paper);
    EXPECT_EQ(named.exit_code, 2) << named.err;
    EXPECT_EQ(named.err.find("the link's own array"), std::string::npos) << named.err;
  };
  const auto of_a_nudge = [&] {
    const auto nudged = emulation.folder() / "nudged.toml";
    succeeded(palpa({"calibrate", "--nudge", "--backend", "cpu", "--link", "openmpd:EMU3", "--keys", "right enter",
                     "--out", nudged.string()},
                    options));
    EXPECT_CONTAINS(read_text(nudged), "layout = \"openmpd\"");
  };
  side_by_side({beside_a_rig, of_a_nudge});
  emulation.end(1);
}

TEST(OpenMpdRun, ItsStatisticsSayWhatTheWireCarried) {
  const auto trace = scratch_folder("openmpd-counts-trace") / "wire.jsonl";
  Emulation emulation("openmpd-counts", "EMU1", {"--trace", trace.string()});
  const RunOptions options{.environment = emulation.environment()};
  const Result result = succeeded(
      palpa(with(with({"run"}, run_to("openmpd:EMU1", "openmpd")), {"--frames", "30", "--steps", "off", "--json", "-"}),
            options));
  emulation.end();
  const std::uint64_t heard = heard_in(trace).sounding;
  const json drives = json::parse(result.out)["hand_over"]["drives"];
  EXPECT_EQ(drives["completed"], heard) << drives;
  EXPECT_GE(drives["submitted"], drives["completed"]);
  EXPECT_GE(drives["guard"], drives["submitted"]);
  EXPECT_GE(drives["loop"], drives["guard"]);
  const auto lost = drives["lost"].get<std::uint64_t>(), loop = drives["loop"].get<std::uint64_t>();
  EXPECT_EQ(lost, loop - heard);
  // A busy machine loses some drives, and palpa warns of more than these.
  if (result.err.find("drives were lost between loop and device") == std::string::npos) {
    EXPECT_LE(lost, 8 + loop / 50) << drives;
  }
}

/// The guard of a run, once it has one.
pid_t guard_of(LiveRun& run) {
  const auto tasks = std::filesystem::path("/proc") / std::to_string(run.id()) / "task";
  pid_t guard = -1;
  begins([&] {
    std::error_code none;
    for (const auto& task : std::filesystem::directory_iterator(tasks, none))
      std::ifstream(task.path() / "children") >> guard;
    return guard > 0 || run.wait(0).ended;
  });
  return guard;
}

/// What a busy machine does to programs, without making others wait: each in turn gets no processor for up to `most`.
void hold_up(std::span<const pid_t> programs, int times, std::chrono::milliseconds most) {
  std::mt19937 random(1);
  const auto rest = [&] {
    std::this_thread::sleep_for(std::chrono::microseconds(random() % std::chrono::microseconds(most).count()));
  };
  for (int i = 0; i < times; ++i) {
    const pid_t program = programs[static_cast<std::size_t>(i) % programs.size()];
    if (program <= 1 || kill(program, SIGSTOP) != 0) return;  // it has ended
    rest();
    kill(program, SIGCONT);
    rest();
  }
}

TEST(OpenMpdRun, ItsQueueNeverHoldsMoreThanASlotWhereProgramsAreHeldUp) {
  // By the emulator's own clock, so that no speed of the machine makes a difference.
  const auto trace = scratch_folder("openmpd-queue-trace") / "wire.jsonl";
  Emulation emulation("openmpd-queue", "EMU1", {"--trace", trace.string()});
  const auto said = scratch_folder("openmpd-queue-said") / "stderr";
  const Unread err = Unread::file(said);
  LiveRun run(run_to("openmpd:EMU1", "openmpd"), {.err = &err, .environment = emulation.environment()});
  // Drives are many frames, and silence is none: a frame has 1024 digits in the trace.
  const auto sounds_on = [&] {
    const std::uintmax_t enough = std::filesystem::file_size(trace) + 100 * 1024;
    const auto heard = [&] { return std::filesystem::file_size(trace) >= enough; };
    begins([&] { return heard() || run.wait(0).ended; });
    return heard();
  };
  const bool sounded = sounds_on();
  if (sounded) hold_up(std::array{guard_of(run), run.id(), emulation.id()}, 90, std::chrono::milliseconds(12));
  const bool sounds = sounded && sounds_on();
  run.signal(SIGTERM);
  const LiveRun::End end = run.wait(60);
  // What else the machine does may hold programs up for longer, which ends a run. Its board is judged all the same.
  const std::string told = read_text(said);
  const bool too_long = end.exit_code == 1 && (told.find("took no drive for 1 s") != std::string::npos ||
                                               told.find("they take no bytes") != std::string::npos);
  EXPECT_TRUE((sounds && end.in_order()) || too_long) << told;
  const json board = emulation.end()["boards"][0];
  EXPECT_EQ(board["violation_count"], 0) << board;
  EXPECT_LE(board["most_buffered_bytes"], 16 * 512) << "15 frames, and a silence";
  if (sounded) {
    EXPECT_GE(board["most_buffered_bytes"], 4 * 512) << "a drive is several frames";
  }
  EXPECT_FALSE(board["sounds"].get<bool>());
}

/// Every command that plays, in front of a board that hangs, or that is unplugged, when Ctrl-C comes.
TEST(OpenMpdRun, EveryEndSaysThatABoardOutOfReachMaySound) {
  const std::vector<std::string> play{"play", "circle", "--link", "openmpd:EMU1", "--ceiling", "0.5"},
      link{"link", "test", "--link", "openmpd:EMU1", "--each", "100s"},
      nudge{"calibrate", "--nudge",   "--backend", "cpu", "--link", "openmpd:EMU1", "--noise-free",
            "--keys",    "right*900", "--ceiling", "0.5", "--out",  "nudged.toml"},
      run = with({"run"}, run_to("openmpd:EMU1", "openmpd"));
  const auto ends = [](const std::vector<std::string>& command, int what) {
    SCOPED_TRACE(command.front() + ", " + strsignal(what));
    const std::string name = "openmpd-end-" + command.front() + std::to_string(what);
    const auto trace = scratch_folder(name + "-trace") / "wire.jsonl", said = scratch_folder(name + "-said") / "stderr";
    Emulation emulation(name, "EMU1", {"--trace", trace.string()});
    const Unread err = Unread::file(said);
    LiveOptions options{.err = &err, .environment = emulation.environment()};
    options.command = command.front().c_str();
    LiveRun live({command.begin() + 1, command.end()}, options);
    ASSERT_TRUE(begins([&] { return heard_in(trace).sounding > 0 || live.wait(0).ended; })) << read_text(said);
    kill(emulation.id(), what);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // until it has room for no more
    live.signal(SIGINT);
    const LiveRun::End end = live.wait(60);
    EXPECT_TRUE(end.ended);
    EXPECT_EQ(end.exit_code, 1);
    const std::string told = read_text(said);
    EXPECT_CONTAINS(told, ": error: ");
    EXPECT_CONTAINS(told, "the array (openmpd:EMU1) ");
    EXPECT_CONTAINS(told, ": it may still sound, switch it off\n");
    kill(emulation.id(), SIGCONT);
  };
  side_by_side({[&] { ends(run, SIGSTOP); }, [&] { ends(play, SIGSTOP); }, [&] { ends(link, SIGSTOP); },
                [&] { ends(nudge, SIGKILL); }, [&] { ends(run, SIGKILL); }});
}

/// A run that fails says that its board is silent.
TEST(OpenMpdRun, AnErrorSaysThatTheBoardIsSilent) {
  Emulation emulation("openmpd-error", "EMU1");
  const RunOptions options{.environment = emulation.environment()};
  const Result result = palpa(
      with(with({"run"}, run_to("openmpd:EMU1", "openmpd")), {"--ceiling", "0.5", "--events", "/dev/full"}), options);
  expect_failure(result, 1, "; the array (openmpd:EMU1) is silent");
  emulation.end();
}

TEST(OpenMpdRun, FociThatStandStillHaveFineSlotsUnlessTheLineSaysOtherwise) {
  Emulation emulation("openmpd-still", "EMU1");
  const RunOptions options{.environment = emulation.environment()};
  const auto slot_s = [&](const std::vector<std::string>& more) {
    const Result result = succeeded(
        palpa(with(with({"run"}, run_to("openmpd:EMU1", "openmpd")), with({"--frames", "20", "--json", "-"}, more)),
              options));
    const json stats = json::parse(result.out);
    EXPECT_TRUE(stats.contains("audible_dba")) << "something was touched";
    const json& drives = stats["drives"];
    constexpr double hold_s = 0.5;  // silence comes so long after the last frame
    return (stats["seconds"].get<double>() + hold_s) /
           (drives["sent"].get<double>() + drives["skipped_slots"].get<double>());
  };
  // A busy machine may end a run later than this expects, but hardly five times.
  const auto expect_slots = [&](double s, const std::vector<std::string>& more) {
    double found_s = 0;
    for (int again = 0; again < 5 && std::abs(found_s - s) > 0.2 * s; ++again)
      found_s = slot_s(more);
    EXPECT_NEAR(found_s, s, 0.2 * s);
  };
  expect_slots(1.5e-3, {});
  expect_slots(0.3e-3, {"--method", "single-focus"});
  expect_slots(1.5e-3, {"--method", "single-focus", "--steps", "off"});
  expect_slots(1e-3, {"--method", "single-focus", "--dwell", "1ms"});
  emulation.end();
}

/// With factors of one half, a ceiling of 0.04 is silent, and a request is played all the same.
TEST(OpenMpdRun, TheFactorsOfABoardsFileAndRequestedPressuresCountAsOnTheWire) {
  openmpd::Calibration half;
  half.factors.fill(0.5f);
  for (const bool requests : {false, true}) {
    const auto trace = scratch_folder("openmpd-law-trace") / "wire.jsonl";
    Emulation emulation("openmpd-law", "EMU1", {"--trace", trace.string()});
    write_text(emulation.folder() / "board_1.pat", board_file_text("EMU1", half));
    const RunOptions options{.environment = emulation.environment()};
    const std::vector<std::string> how =
        requests ? std::vector<std::string>{"--pressure", "300"} : std::vector<std::string>{"--ceiling", "0.04"};
    const Result result = succeeded(palpa(with(with({"run"}, run_to("openmpd:EMU1", "openmpd")),
                                               with({"--frames", "30", "--json", "-", "--method", "single-focus",
                                                     "--steps", "off", "--board-files", emulation.folder().string()},
                                                    how)),
                                          options));
    emulation.end();
    const json stats = json::parse(result.out);
    const std::uint64_t heard = heard_in(trace).sounding;
    EXPECT_EQ(stats["hand_over"]["drives"]["completed"], heard);
    if (requests) {
      EXPECT_GT(heard, 0u);
      EXPECT_LE(stats["fingers"][0]["pressure_pa"]["most"].get<double>(), 300.01);
      EXPECT_GT(stats["fingers"][0]["pressure_pa"]["least"].get<double>(), 285);
    } else {
      EXPECT_EQ(heard, 0u);
      EXPECT_EQ(stats["hand_over"]["drives"]["loop"], 0u);
      EXPECT_CONTAINS(result.err, "the least that OpenMPD boards play with the factors of their files is 0.0491");
      EXPECT_EQ(result.err.find("were lost"), std::string::npos) << result.err;
    }
  }
}

TEST(OpenMpdRun, ASensationIsHeardToItsSilentEnd) {
  for (const bool steps : {true, false}) {
    const auto trace = scratch_folder("openmpd-sensation-trace") / "wire.jsonl";
    Emulation emulation("openmpd-sensation", "EMU1", {"--trace", trace.string()});
    const RunOptions options{.environment = emulation.environment()};
    const Result result = succeeded(palpa({"play", "circle", "--link", "openmpd:EMU1", "--duration", "500ms", "--dwell",
                                           "0.5ms", "--ceiling", "0.5", "--json", "-", "--steps", steps ? "on" : "off"},
                                          options));
    const json report = emulation.end();
    EXPECT_EQ(report["boards"][0]["violation_count"], 0) << report;
    EXPECT_FALSE(report["boards"][0]["sounds"].get<bool>());
    const Heard heard = heard_in(trace);
    const json drives = json::parse(result.out)["drives"];
    EXPECT_TRUE(heard.ends_silent());
    EXPECT_GT(heard.sounding, 0u);
    // A drive of five frames goes there in four of them, or in fewer if it comes late or begins; without steps in one.
    const std::uint64_t sounded = drives["sent"].get<std::uint64_t>() - drives["silent"].get<std::uint64_t>() -
                                  drives["lost"].get<std::uint64_t>();
    EXPECT_LE(heard.sounding, (steps ? 4 : 1) * sounded) << drives;
    EXPECT_GE(heard.sounding, sounded) << drives;
    EXPECT_GE(drives["sent"].get<std::uint64_t>() + drives["skipped_slots"].get<std::uint64_t>(), 1000u);
  }
}

TEST(OpenMpdRun, LinkTestPlaysOneTransducerAfterTheOther) {
  const auto trace = scratch_folder("openmpd-trace") / "wire.jsonl";
  Emulation emulation("openmpd-test", "EMU1", {"--trace", trace.string()});
  const RunOptions options{.environment = emulation.environment()};
  const Result result = succeeded(palpa({"link", "test", "--layout", "openmpd", "--link", "openmpd:EMU1", "--first",
                                         "64", "--last", "65", "--each", "60ms", "--rest", "40ms"},
                                        options));
  EXPECT_CONTAINS(result.out, "65 at -36.8, 68.2, 0.0 mm");
  emulation.end();
  std::string hex;
  std::ifstream wire(trace);
  for (std::string line; std::getline(wire, line);) {
    const json entry = json::parse(line);
    if (entry["kind"] == "bulk") hex += entry["hex"].get<std::string>();
  }
  ASSERT_EQ(hex.size() % 1024, 0u);
  // In the order of their first sound: a loop that a busy computer holds up falls silent in between, and continues.
  std::vector<std::string> sounding;
  for (std::size_t at = 0; at < hex.size(); at += 1024) {
    const std::string amplitudes = hex.substr(at + 512, 512);
    if (std::find(sounding.begin(), sounding.end(), amplitudes) == sounding.end()) sounding.push_back(amplitudes);
  }
  const auto only = [](std::size_t pin) {
    std::string amplitudes(512, '0');
    return amplitudes.replace(2 * pin, 2, "40");
  };
  const std::string none(512, '0');
  // Column 4: the third quarter of the pins; see the boards' own files.
  EXPECT_EQ(sounding, (std::vector{none, only(185), only(189)}));
  EXPECT_EQ(hex.substr(hex.size() - 512), none);
}

TEST(OpenMpdRun, ABoardInSerialModeIsRefusedBeforeItGetsAByte) {
  const auto trace = scratch_folder("openmpd-uart-trace") / "wire.jsonl";
  Emulation emulation("openmpd-uart", "EMU1", {"--uart", "--trace", trace.string()});
  const RunOptions options{.environment = emulation.environment()};
  const Result result = palpa({"link", "test", "--layout", "openmpd", "--link", "openmpd:EMU1"}, options);
  expect_failure(result, 1, "its EEPROM says serial (UART)");
  emulation.end();
  EXPECT_EQ(heard_in(trace).bytes, 0u);
}

}  // namespace
}  // namespace palpa::test
