// Outputs of a live loop that nobody reads: it continues to sound, and a signal ends it in silence within a second.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <functional>

#include "cli/support/heard_drives.hpp"
#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// The second that palpa promises, and as much again for the system; more in instrumented builds.
constexpr double a_second = instrumented() ? 6 : 2;

std::string cube() {
  return source_file("assets/cube.glb").string();
}

/// The cube under another name.
fs::path named_cube(const fs::path& folder, const std::string& name) {
  auto meshes = geometry::load_gltf(cube()).meshes;
  meshes.at(0).name = name;
  geometry::write_glb(folder / "cube.glb", meshes);
  return folder / "cube.glb";
}

/// A session with a listener.
struct Stage {
  fs::path folder;
  UdpReceiver receiver;
  std::string last;

  explicit Stage(const std::string& name) : folder(scratch_folder(name)) {}

  std::vector<std::string> line(const std::vector<std::string>& more, const std::string& scene = cube()) const {
    return with(with({"--scene", scene, "--link", "foci:" + receiver.address()}, small_frames()), more);
  }
  /// Receives lines until at least `sounding` of them sound and there are at least `any` lines.
  void hear(int sounding, int any = 0) {
    for (int heard = 0, all = 0; heard < sounding || all < any; ++all) {
      last = receiver.next();
      ASSERT_FALSE(last.empty()) << "it stopped sounding after " << heard << " of " << sounding << " lines";
      heard += json::parse(last)["fingers"].empty() ? 0 : 1;
    }
  }
  /// Receives all remaining lines of a program that sends no more.
  void hear_the_end() {
    for (std::string next = last; !next.empty(); next = receiver.waiting())
      last = next;
  }
  void expect_silent_end(LiveRun& run, int signal = SIGTERM) {
    run.signal(signal);
    const LiveRun::End end = run.wait(60);
    EXPECT_TRUE(end.ended);
    EXPECT_EQ(end.by_signal, 0);
    EXPECT_LT(end.after_s, a_second);
    hear_the_end();
    EXPECT_TRUE(json::parse(last)["fingers"].empty()) << last;
    last.clear();
  }
};

TEST(CliSilence, NobodyReadsWhatItPrints) {
  Stage warnings("silence-stderr"), results("silence-stdout"), both("silence-both");
  const Unread full = Unread::pipe();
  const auto warns = [&] {
    // A line that no datagram holds: silence goes in its place, and there is a warning.
    LiveRun run(warnings.line({}, named_cube(warnings.folder, std::string(66'000, 'n'))), {.err = &full});
    warnings.hear(0, 60);
    warnings.expect_silent_end(run);
  };
  const auto has_results = [&] {
    LiveRun run(results.line({"--stats", "json"}), {.out = &full});
    results.hear(20);
    results.expect_silent_end(run);
  };
  const auto has_both = [&] {
    LiveRun run(both.line({"--events", "-", "--event-move", "0"}), {.out = &full, .err = &full});
    both.hear(60);
    both.expect_silent_end(run, SIGINT);
  };
  side_by_side({warns, has_results, has_both});
}

TEST(CliSilence, ItsTerminalIsStopped) {
  PALPA_TERMINAL_OR_SKIP();
  Stage stage("silence-terminal");
  Unread terminal = Unread::terminal();
  LiveRun run(stage.line({}), {.err = &terminal, .foreground = true});
  stage.hear(20);
  std::string seen;  // the line with the state is drawn twice a second
  EXPECT_TRUE(begins([&] { return (seen += terminal.read_all()).find("SOUNDING") != std::string::npos; })) << seen;
  terminal.stop();
  stage.hear(60);  // twice a second it would draw
  stage.expect_silent_end(run);
}

TEST(CliSilence, NobodyReadsItsEvents) {
  Stage newest("silence-events"), every_frame("silence-events-every-frame");
  const auto sounds_on = [](Stage& stage, const std::vector<std::string>& options) {
    const fs::path fifo = stage.folder / "events";
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    LiveRun run(with(stage.line({"--events", fifo.string(), "--event-move", "0"}), options));
    stage.hear(40);
    stage.expect_silent_end(run);
    close(reader);
  };
  side_by_side({[&] { sounds_on(newest, {}); }, [&] { sounds_on(every_frame, {"--every-frame"}); }});
}

TEST(CliSilence, NobodyReadsItsDrives) {
  Stage stage("silence-drives");
  const auto ends = [&](const char* name, const std::function<void(LiveRun&, int)>& wait_until) {
    const fs::path fifo = stage.folder / name;
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    LiveRun run(with({"--scene", cube(), "--link", "record:" + fifo.string()}, small_frames()));
    wait_until(run, reader);
    if (!run.wait(0).ended) {
      run.signal(SIGTERM);
      EXPECT_LT(run.wait(60).after_s, a_second);
    }
    close(reader);
  };
  const auto before_it_sounds = [&] { ends("early", [](LiveRun& run, int) { run.wait(0.3); }); };
  const auto while_it_waits = [&] {
    ends("late", [](LiveRun& run, int reader) {
      int bytes = 0;  // two drives fill the pipe
      EXPECT_TRUE(begins([&] { return ioctl(reader, FIONREAD, &bytes) == 0 && bytes > 60'000; }));
      run.wait(0.3);
    });
  };
  const auto by_itself = [&] {
    ends("alone", [](LiveRun& run, int) { EXPECT_EQ(run.wait(120).exit_code, 1) << "the link gives up"; });
  };
  side_by_side({before_it_sounds, while_it_waits, by_itself});
}

/// With a disk in `folder` that answers until hang() is called. Something must have been written to it after that.
struct HungDisk {
  fs::path folder;
  ~HungDisk() { EXPECT_TRUE(fs::exists(folder / "held")) << "no write to " << folder << " was held up"; }
  std::vector<std::pair<std::string, std::string>> environment() const {
    // A path in LD_PRELOAD would end at a space.
    const fs::path library = PALPA_HUNG_DISK;
    return {{"LD_PRELOAD", library.filename().string()},
            {"LD_LIBRARY_PATH", library.parent_path().string()},
            {"HUNG_DISK", folder.string()}};
  }
  void hang() const { write_text(folder / "hangs", ""); }
  void answer() const { fs::remove(folder / "hangs"); }
};

TEST(CliSilence, TheDiskOfItsFilesOrOfItsMessagesDoesNotAnswer) {
  if (instrumented()) GTEST_SKIP() << "skipped: a sanitizer's own preloads come first";
  Stage recorded("silence-recording"), told("silence-events-disk"), warned("silence-messages-disk");
  const auto writes = [](Stage& stage, const std::vector<std::string>& options) {
    const HungDisk disk{fs::canonical(stage.folder)};
    LiveRun run(stage.line(options), {.environment = disk.environment()});
    stage.hear(10);
    disk.hang();
    stage.hear(60);
    stage.expect_silent_end(run);
  };
  const auto messages = [&] {
    const HungDisk disk{fs::canonical(warned.folder)};
    const Unread file = Unread::file((disk.folder / "messages").string());
    const fs::path scene = named_cube(warned.folder, std::string(66'000, 'n'));  // palpa warns about this name
    disk.hang();
    LiveRun run(warned.line({}, scene), {.err = &file, .environment = disk.environment()});
    warned.hear(0, 60);
    warned.expect_silent_end(run);
  };
  side_by_side({[&] {
                  writes(recorded, {"--record", recorded.folder / "take"});
                },
                [&] {
                  writes(told, {"--events", told.folder / "events", "--event-move", "0"});
                },
                messages});
}

TEST(CliSilence, TheDiskOfItsDrivesDoesNotAnswer) {
  if (instrumented()) GTEST_SKIP() << "skipped: a sanitizer's own preloads come first";
  Stage soon("silence-drives-disk"), later("silence-drives-disk-later");
  const auto ends = [](const Stage& stage, double after_s) {
    const HungDisk disk{fs::canonical(stage.folder)};
    const fs::path drives = disk.folder / "drives";
    LiveRun run(with({"--scene", cube(), "--link", "record:" + drives.string()}, small_frames()),
                {.environment = disk.environment()});
    EXPECT_TRUE(begins([&] { return fs::exists(drives) && fs::file_size(drives) > 10'000'000; })) << "too few drives";
    disk.hang();
    run.wait(after_s);
    run.signal(SIGTERM);
    EXPECT_LT(run.wait(60).after_s, a_second);
  };
  side_by_side({[&] { ends(soon, 0.05); }, [&] { ends(later, 1.5); }});
}

TEST(CliSilence, ADiskThatPausesLosesNothing) {
  if (instrumented()) GTEST_SKIP() << "skipped: a sanitizer's own preloads come first";
  Stage steady("silence-steady-disk"), pausing("silence-pausing-disk");
  // Drives of a small array: what waits for the disk has room in memory, even if the driver compiles its shaders first.
  const auto line = [](const Stage& stage) {
    return with({"--scene", cube(), "--layout", "openmpd", "--frames", "100", "--every-frame", "--events",
                 (stage.folder / "events").string(), "--event-move", "0", "--link",
                 "record:" + (stage.folder / "drives").string()},
                small_frames());
  };
  const auto without_pause = [&] {
    LiveRun run(line(steady));
    EXPECT_EQ(run.wait(120).exit_code, 0);
  };
  const auto with_pause = [&] {
    const HungDisk disk{fs::canonical(pausing.folder)};
    const Unread messages = Unread::file((disk.folder / "messages").string());
    const fs::path drives = disk.folder / "drives";
    LiveRun run(line(pausing), {.err = &messages, .environment = disk.environment()});
    EXPECT_TRUE(begins([&] { return fs::exists(drives) && fs::file_size(drives) > 100'000; })) << "too few drives";
    disk.hang();
    EXPECT_FALSE(run.wait(4).ended) << "it did not wait for its disk: " << read_text(disk.folder / "messages");
    disk.answer();
    EXPECT_EQ(run.wait(120).exit_code, 0) << read_text(disk.folder / "messages");
  };
  side_by_side({without_pause, with_pause});
  EXPECT_EQ(read_text(pausing.folder / "events"), read_text(steady.folder / "events"));
  read_to_silence(pausing.folder / "drives");
}

TEST(CliSilence, AProgramThatWasStoppedGoesOnInSilence) {
  Stage stage("silence-stopped");
  LiveRun run(stage.line({"--quiet"}));
  stage.hear(10);
  run.signal(SIGSTOP);
  run.wait(0.5);  // five times the longest time that a frame sounds
  stage.hear_the_end();
  run.signal(SIGCONT);
  const std::string first = stage.receiver.next();
  ASSERT_FALSE(first.empty());
  EXPECT_TRUE(json::parse(first)["fingers"].empty()) << "it plays what it saw half a second ago: " << first;
  stage.hear(10);
  stage.expect_silent_end(run);
}

}  // namespace
}  // namespace palpa::test
