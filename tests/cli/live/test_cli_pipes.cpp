// Named pipes that nobody reads: for a link, this is soon an error, because its array would wait with it. For results,
// palpa waits and says so in a line, also with --quiet. Ctrl-C ends the wait.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "cli/support/tiny_files.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

class CliPipes : public testing::Test {
 protected:
  CliPipes() {
    fs::create_directory(folder_ / "take");
    write_depth(folder_ / "take/depth-0.png");
    write_recording(folder_ / "take/recording.toml", "files = [\"depth-%d.png\"]\n");
    write_text(folder_ / "layout.toml", "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n");
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string pipe(const std::string& name) const {
    EXPECT_EQ(mkfifo(path(name).c_str(), 0600), 0);
    return path(name);
  }
  std::vector<std::string> recorded(const std::vector<std::string>& more) const {
    return with({"--scene", source_file("assets/cube.glb").string(), "--source", "recording:" + path("take"),
                 "--backend", "cpu"},
                more);
  }
  std::vector<std::string> sounding(const std::vector<std::string>& more) const {
    return with(recorded({"--layout", path("layout.toml")}), more);
  }

  /// A program that waits; what it says goes to a file.
  struct Waiting {
    std::string name, said;
    std::unique_ptr<Unread> err;
    std::unique_ptr<LiveRun> run;
  };
  Waiting begin(const char* command, const std::vector<std::string>& arguments) {
    Waiting one{command, path("said-" + std::to_string(begun_++)), nullptr, nullptr};
    one.err = std::make_unique<Unread>(Unread::file(one.said));
    LiveOptions options;
    options.err = one.err.get();
    options.command = command;
    one.run = std::make_unique<LiveRun>(arguments, options);
    return one;
  }
  static bool says(const Waiting& one, const std::string& part) {
    return begins([&] { return read_text(one.said).find(part) != std::string::npos; });
  }

  fs::path folder_ = scratch_folder("pipes");
  int begun_ = 0;
  const std::string waits_ = "palpa waits for somebody to read this pipe";
};

TEST_F(CliPipes, OfLinksThatNobodyReadsAreErrors) {
  const std::string fifo = pipe("drives"), part = fifo + ": nobody reads this pipe";
  expect_failure(palpa(with({"run"}, sounding({"--link", "record:" + fifo}))), 1, part);
  expect_failure(palpa({"link", "test", "--layout", path("layout.toml"), "--link", "record:" + fifo}), 1, part);
}

TEST_F(CliPipes, OfResultsAreWaitedForAndThatIsSaid) {
  const std::string layout = path("layout.toml");
  std::vector<Waiting> all;
  all.push_back(begin("drive", {"--layout", layout, "--focus", "0,0,0.1", "--backend", "cpu", "--csv", pipe("a")}));
  all.push_back(begin(
      "drive", {"--layout", layout, "--focus", "0,0,0.1", "--backend", "cpu", "--quiet", "--csv", pipe("quiet")}));
  all.push_back(begin("field", {"--layout", layout, "--focus", "0,0,0.1", "--plane", "xy", "--size", "2mm,2mm",
                                "--pixels", "2,2", "--backend", "cpu", "--csv", pipe("b")}));
  all.push_back(begin("export", recorded({"--foci", pipe("c.json")})));
  all.push_back(begin("export", recorded({"--events", pipe("d")})));
  all.push_back(begin("export", sounding({"--drives", pipe("e")})));
  all.push_back(begin("run", sounding({"--events", pipe("f")})));
  all.push_back(begin("run", sounding({"--json", pipe("g")})));
  all.push_back(begin("emulate", {"openmpd", "--trace", pipe("h")}));
  all.push_back(begin("emulate", {"autd3", "--port", "0", "--layout", "autd3", "--trace", pipe("i")}));
  for (const Waiting& one : all)
    EXPECT_TRUE(says(one, waits_)) << one.name << ": " << read_text(one.said);
  for (const Waiting& one : all) {
    SCOPED_TRACE(one.name);
    one.run->signal(SIGINT);
    const LiveRun::End end = one.run->wait(60);
    EXPECT_TRUE(end.ended);
    EXPECT_TRUE(end.by_signal == SIGINT || end.exit_code == 1) << end.by_signal << ' ' << end.exit_code;
    EXPECT_EQ(read_text(one.said).find(waits_), read_text(one.said).rfind(waits_)) << "it is reported once";
  }
}

TEST_F(CliPipes, OfResultsGoOnWithTheirReader) {
  const std::string fifo = pipe("csv");
  const Waiting drive =
      begin("drive", {"--layout", path("layout.toml"), "--focus", "0,0,0.1", "--backend", "cpu", "--csv", fifo});
  EXPECT_TRUE(says(drive, waits_));
  EXPECT_TRUE(read_text(fifo).starts_with("index,x,y,z,"));
  const LiveRun::End end = drive.run->wait(60);
  EXPECT_EQ(end.exit_code, 0) << read_text(drive.said);
}

}  // namespace
}  // namespace palpa::test
