// `palpa emulate openmpd` as a program of its own, and what its boards heard.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
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
    for (int i = 0; i < 400 && !std::filesystem::exists(socket); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(std::filesystem::exists(socket));
  }
  Environment environment() const { return {{"XDG_RUNTIME_DIR", folder_.string()}}; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Ends it and returns its report.
  nlohmann::json end(int& exit_code) {
    run_->signal(SIGTERM);
    const LiveRun::End end = run_->wait(10);
    EXPECT_TRUE(end.ended);
    exit_code = end.exit_code;
    std::ifstream file(report());
    return nlohmann::json::parse(file);
  }

 private:
  std::filesystem::path report() const { return folder_ / "report.json"; }

  std::filesystem::path folder_;
  std::optional<LiveRun> run_;
};

/// The bytes of all bulk transfers of a trace, one board's.
inline std::string wire_of(const std::filesystem::path& trace) {
  std::string hex;
  std::ifstream file(trace);
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line, nullptr, false);  // the last line may be incomplete
    if (!entry.is_discarded() && entry["kind"] == "bulk") hex += entry["hex"].get<std::string>();
  }
  return hex;
}

/// Whether the frame of the wire that begins at `at` has an amplitude.
inline bool sounds(const std::string& wire, std::size_t at) {
  return wire.substr(at + 512, 512).find_first_not_of('0') != std::string::npos;
}

/// Whether any frame of the wire has an amplitude.
inline bool sounded(const std::string& wire) {
  for (std::size_t at = 0; at + 1024 <= wire.size(); at += 1024) {
    if (sounds(wire, at)) return true;
  }
  return false;
}

/// Whether the last frame of the wire has no amplitude.
inline bool ended_silent(const std::string& wire) {
  return wire.size() >= 1024 && !sounds(wire, wire.size() / 1024 * 1024 - 1024);
}

/// What a board has heard, over several loops, each of which brings it into step again.
struct Heard {
  std::size_t bytes = 0, frames = 0;
  std::size_t last_sounding = 0;  ///< number of the last frame with an amplitude, from 1; 0: none
  bool ends_silent() const { return last_sounding < frames || frames == 0; }
};

/// Frames of 512 bytes begin with bit 7: 256 phases, 256 pulse widths. A board drops a part of one after a second.
inline Heard heard_in(const std::filesystem::path& trace) {
  Heard heard;
  std::ifstream file(trace);
  std::string frame;
  double last_s = 0;
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line, nullptr, false);
    if (entry.is_discarded() || entry["kind"] != "bulk") continue;
    const double now_s = entry["t_s"];
    if (now_s - last_s >= 1) frame.clear();
    last_s = now_s;
    const std::string hex = entry["hex"];
    for (std::size_t at = 0; at + 2 <= hex.size(); at += 2, ++heard.bytes) {
      const int byte = std::stoi(hex.substr(at, 2), nullptr, 16);
      if (!frame.empty() || (byte & 0x80) != 0) frame += static_cast<char>(byte);
      if (frame.size() < 512) continue;
      ++heard.frames;
      const bool sounds = std::any_of(frame.begin() + 256, frame.end(), [](char width) { return (width & 0x7f) != 0; });
      if (sounds) heard.last_sounding = heard.frames;
      frame.clear();
    }
  }
  return heard;
}

}  // namespace palpa::test
