// `palpa emulate openmpd` as a program of its own, and what its boards heard.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "support/begins.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

/// A runtime folder, and emulated boards that use it.
class Emulation {
 public:
  Emulation(const std::string& name, const std::string& serials, const std::vector<std::string>& more = {})
      : folder_(scratch_folder(name)) {
    LiveOptions options;
    options.environment = environment();
    options.command = "emulate";
    run_.emplace(with({"openmpd", "--serial", serials, "--json", report().string()}, more), options);
    const std::size_t boards = 1 + static_cast<std::size_t>(std::count(serials.begin(), serials.end(), ','));
    const auto socket = folder_ / "palpa" / ("usb-" + std::to_string(boards) + ".sock");
    EXPECT_TRUE(begins([&] { return std::filesystem::exists(socket); }));
  }
  Environment environment() const { return {{"XDG_RUNTIME_DIR", folder_.string()}}; }
  const std::filesystem::path& folder() const { return folder_; }
  pid_t id() const { return run_->id(); }
  /// Ends it and returns its report. It fails if its boards have heard different numbers of frames.
  nlohmann::json end(int exit_code = 0) {
    run_->signal(SIGTERM);
    const LiveRun::End end = run_->wait(60);
    std::ifstream file(report());
    nlohmann::json heard = nlohmann::json::parse(file);
    EXPECT_EQ(end.exit_code, exit_code) << heard;
    return heard;
  }

 private:
  std::filesystem::path report() const { return folder_ / "report.json"; }

  std::filesystem::path folder_;
  std::optional<LiveRun> run_;
};

/// What a board has heard, over several loops, each of which brings it into step again.
struct Heard {
  std::size_t bytes = 0, frames = 0;
  std::size_t sounding = 0;       ///< frames with an amplitude
  std::size_t last_sounding = 0;  ///< number of the last of these, from 1; 0: none
  bool ends_silent() const { return last_sounding < frames || frames == 0; }
};

/// Frames of 512 bytes begin with bit 7: 256 phases, 256 pulse widths. A board drops a part of one after a second.
/// A trace grows by 10 MB a second, so this takes its lines apart itself, and stops where the trace ended at first.
inline Heard heard_in(const std::filesystem::path& trace) {
  Heard heard;
  std::error_code missing;
  auto left = static_cast<std::int64_t>(std::filesystem::file_size(trace, missing));
  if (missing) return heard;
  std::ifstream file(trace);
  std::string frame;
  double last_s = 0;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10; };
  for (std::string line; left > 0 && std::getline(file, line); left -= static_cast<std::int64_t>(line.size()) + 1) {
    constexpr std::string_view time = "{\"t_s\":", data = "\"kind\":\"bulk\"", bytes = "\"hex\":\"";
    const std::size_t hex = line.find(bytes);
    if (!line.starts_with(time) || !line.ends_with("\"}") || line.find(data) > hex || hex == line.npos) continue;
    const double now_s = std::strtod(line.c_str() + time.size(), nullptr);
    if (now_s - last_s >= 1) frame.clear();
    last_s = now_s;
    for (std::size_t at = hex + bytes.size(); at + 4 <= line.size(); at += 2, ++heard.bytes) {
      const int byte = 16 * digit(line[at]) + digit(line[at + 1]);
      if (!frame.empty() || (byte & 0x80) != 0) frame += static_cast<char>(byte);
      if (frame.size() < 512) continue;
      ++heard.frames;
      if (std::any_of(frame.begin() + 256, frame.end(), [](char width) { return (width & 0x7f) != 0; })) {
        ++heard.sounding;
        heard.last_sounding = heard.frames;
      }
      frame.clear();
    }
  }
  return heard;
}

}  // namespace palpa::test
