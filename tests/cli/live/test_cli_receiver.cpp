// The receiver in docs/examples that users may copy: it plays what it is sent, and nothing else.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/udp_sender.hpp"

namespace palpa::test {
namespace {

using namespace std::chrono_literals;

std::string cube() {
  return source_file("assets/cube.glb").string();
}

bool without_python() {
  return std::system("python3 -c pass >/dev/null 2>&1") != 0;
}

/// Runs a script (the first argument), whose clock is 1000 s later as soon as a file exists. Once it has looked at the
/// clock a few times since, another file does.
constexpr const char* jumping_clock = R"(import os, runpy, sys, time
_, script, jump, *sys.argv[1:] = sys.argv
now, looks = time.monotonic_ns, 0
def later():
    global looks
    looks += os.path.exists(jump)
    if looks == 9:
        open(jump + "ed", "w").close()
    return now() + (10**12 if looks else 0)
time.monotonic_ns = later
runpy.run_path(script, run_name="__main__")
)";

/// The example of docs/boards.md, as it stands there. What it prints goes into a file.
class PythonReceiver {
 public:
  const std::uint16_t port = free_udp_port();
  const UdpSender sender{port};

  explicit PythonReceiver(const std::string& name, const std::string& seconds = "60")
      : folder_(scratch_folder("receiver-" + name)),
        run_({"-c", R"(exec python3 -c "$0" "$@" >"$2.out" 2>&1)", jumping_clock,
              source_file("docs/examples/receive_foci.py"), folder_ / "jump", std::to_string(port), seconds},
             {.program = "/bin/sh"}) {}

  std::vector<std::string> lines() const {
    std::ifstream in(folder_ / "jump.out");
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);)
      all.push_back(line);
    return all;
  }
  /// Waits until the last line of at least `least` ends like that.
  bool says(const std::string& last, std::size_t least = 1) const {
    return begins([&] {
      const std::vector<std::string> all = lines();
      return all.size() >= least && all.back().ends_with(last);
    });
  }
  /// Waits for a line that holds this.
  bool has_said(const std::string& part) const {
    return begins([&] {
      return std::ranges::any_of(lines(), [&](const std::string& line) { return line.find(part) != line.npos; });
    });
  }
  /// 1000 s pass.
  bool waits_long() const {
    write_text(folder_ / "jump", "");
    return begins([&] { return std::filesystem::exists(folder_ / "jumped"); });
  }
  /// As palpa's link.
  std::string link() const { return "foci:udp:127.0.0.1:" + std::to_string(port); }

 private:
  std::filesystem::path folder_;
  LiveRun run_;
};

TEST(Receiver, PlaysWhatItIsTold) {
  if (without_python()) GTEST_SKIP() << "skipped: no python3";
  const PythonReceiver receiver("plays");
  ASSERT_TRUE(receiver.says("listening"));

  succeeded(
      palpa(with({"run", "--scene", cube(), "--frames", "40", "--quiet", "--hold", "1s", "--link", receiver.link()},
                 small_frames())));
  ASSERT_TRUE(receiver.says(": silent", 10));
  const std::size_t before = receiver.lines().size();
  EXPECT_NE(receiver.lines()[1].find("on cube: amplitude 1.000 of focus"), std::string::npos) << receiver.lines()[1];

  // One line, and then nothing more, as of a palpa that was killed.
  const std::string line =
      R"({"time_s": 1, "fingers": [{"id": 1, "solid": "slow", "foci_m": [[0, 0, 0], [0, 0, 0]], "order": [1, 0],)"
      R"("dwell_s": 0.004, "modulation_hz": 0, "gain": 0.5}, {"id": 2, "solid": "fast", "foci_m": [[0, 0, 0], [0, 0, 0],)"
      R"([0, 0, 0]], "order": [0, 2, 1], "dwell_s": 0.001, "modulation_hz": 0, "gain": 0.25}, {"id": 3, "solid":)"
      R"("still", "foci_m": [[0, 0, 0]], "order": [0], "dwell_s": 0.0015, "modulation_hz": 70,)"
      R"("modulation": "pressure-sine", "gain": 0.75}]})";
  receiver.sender.send(line);
  ASSERT_TRUE(receiver.says(": silent", before + 4)) << "it plays on though nobody tells it to";
  const std::vector<std::string> all = receiver.lines();
  long long first_ns = 0, last_ns = 0;
  for (std::size_t i = before; i + 1 < all.size(); ++i) {
    long long t_ns = 0;
    int finger = 0, focus = 0;
    char solid[16];
    double amplitude = 0;
    ASSERT_EQ(std::sscanf(all[i].c_str(), "%lld ns: finger %d on %15[a-z]: amplitude %lf of focus %d", &t_ns, &finger,
                          solid, &amplitude, &focus),
              5)
        << all[i];
    first_ns = i == before ? t_ns : first_ns;
    last_ns = t_ns;
    if (finger == 1) {
      EXPECT_EQ(amplitude, 0.5);
      EXPECT_EQ(focus, 1 - t_ns / 4'000'000 % 2) << all[i];
    } else if (finger == 2) {
      EXPECT_EQ(amplitude, 0.25);
      EXPECT_EQ(focus, (std::array{0, 2, 1})[t_ns / 1'000'000 % 3]) << all[i];
    } else {
      const double raised = 0.5 * (1 + std::sin(2 * std::numbers::pi * 70 * static_cast<double>(t_ns) * 1e-9));
      EXPECT_NEAR(amplitude, 0.75 * std::sqrt(raised), 1e-3);
    }
  }
  EXPECT_LE(last_ns - first_ns, 100'000'000);
}

/// A line of one finger on a solid of that name.
std::string foci_line_on(const std::string& solid) {
  return R"({"time_s": 1, "fingers": [{"id": 1, "solid": ")" + solid +
         R"(", "foci_m": [[0.001, -0.0123, 0.0345]], "order": [0],)"
         R"("dwell_s": 0.0015, "modulation_hz": 0, "gain": 1}]})";
}

TEST(Receiver, TakesNoNoticeOfWhatIsNoLineOfFoci) {
  if (without_python()) GTEST_SKIP() << "skipped: no python3";
  const PythonReceiver receiver("strays", "3");
  ASSERT_TRUE(receiver.says("listening"));
  const std::string line = foci_line_on(R"(W\u00fcrfel\u00a0\u001b[2J)");  // a model's names are its author's business
  const auto with = [&](const std::string& what, const std::string& other) {
    std::string changed = line;
    return changed.replace(changed.find(what), what.size(), other);
  };
  receiver.sender.send("before the first line nothing ends it");
  EXPECT_TRUE(receiver.waits_long());
  receiver.sender.send(line);
  ASSERT_TRUE(receiver.has_said(R"(on W\xfcrfel\xa0\x1b[2J: amplitude 1.000)")) << receiver.lines().back();
  const std::vector<std::string> strays{"hello",
                                        "",
                                        "{}",
                                        "[]",
                                        "3",
                                        "\"fingers\"",
                                        "\xff\xfe",
                                        R"({"fingers": null})",
                                        R"({"fingers": {"a": 1}})",
                                        R"({"fingers": [7]})",
                                        std::string(60000, '['),
                                        with("[0]", "[]"),
                                        with("[0]", "[1]"),
                                        with("[0]", "[-1]"),
                                        with("[0]", "[true]"),
                                        with("[0]", "[[]]"),
                                        with("0.0015", "0"),
                                        with("0.0015", "1e400"),
                                        with("0.0015", "NaN"),
                                        with("[[0.001, -0.0123, 0.0345]]", "[[0, 0]]"),
                                        with(R"("gain": 1)", R"("gain": 2)"),
                                        with(R"("modulation_hz": 0)", R"("modulation_hz": 200)"),
                                        with(R"("id": 1,)", "")};
  // A line that is refused must not prolong what sounds.
  for (const std::string& stray : strays) {
    receiver.sender.send(stray);
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(receiver.says(": silent", 3)) << receiver.lines().back();
  EXPECT_TRUE(receiver.has_said("no line for 3 s"));
  EXPECT_TRUE(receiver.says(std::to_string(strays.size() + 1) + " datagrams were no lines of foci"))
      << receiver.lines().back();
}

TEST(Receiver, ShowsOneLineOnATerminalAndTellsWhatItIgnored) {
  PALPA_TERMINAL_OR_SKIP();
  if (without_python()) GTEST_SKIP() << "skipped: no python3";
  const std::uint16_t port = free_udp_port();
  const UdpSender sender(port);
  Terminal terminal("python3", {source_file("docs/examples/receive_foci.py").string(), std::to_string(port)});
  ASSERT_TRUE(terminal.shows("listening"));
  sender.send("hello");
  sender.send(foci_line_on("a solid whose name is no shorter than half of the terminal's width"));
  ASSERT_TRUE(terminal.shows(": silent"));
  terminal.type("\x03");
  EXPECT_EQ(terminal.ended_by_signal(), 0);
  const std::string& text = terminal.text();
  EXPECT_TRUE(text.ends_with("1 datagrams were no lines of foci\r\n")) << text;
  // Until the end nothing but the one line: no line feed, and none so long that a terminal would go on in the next row.
  const std::size_t end = text.find("the end: silent");
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(text.find('\n'), text.find('\n', end)) << text;
  std::size_t longest = 0;
  for (std::size_t from = 0, to; (to = text.find("\x1b[K", from)) < end; from = to + 4)
    longest = std::max(longest, to - from);
  EXPECT_GT(longest, 60u);
  EXPECT_LE(longest, 80u);  // the carriage return is one of them
}

TEST(Receiver, GoesSilentWhenPalpaCrashes) {
  if (without_python()) GTEST_SKIP() << "skipped: no python3";
  const auto falls_silent = [](int crash) {
    const PythonReceiver receiver(std::to_string(crash));
    ASSERT_TRUE(receiver.says("listening"));
    const LiveRun run(
        with({"--scene", cube(), "--backend", "cpu", "--quiet", "--link", receiver.link()}, small_frames()));
    ASSERT_TRUE(receiver.has_said("on cube: amplitude 1.000"));
    run.signal(crash);
    EXPECT_TRUE(receiver.says(": silent", 3)) << "signal " << crash;
  };
  side_by_side(3, std::vector{SIGSEGV, SIGKILL, SIGSTOP}, falls_silent);  // the receiver sees no difference to others
}

}  // namespace
}  // namespace palpa::test
