#include "base/log.hpp"

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/text.hpp"

namespace palpa::log {
namespace {

std::atomic<Level> threshold{Level::warning};

/// Of a whole line.
constexpr std::size_t longest_line = 500;

void write(Level at, std::string_view line) {
  if (at > threshold.load(std::memory_order_relaxed)) return;
  // Names from files may hold anything; an event stays one line. One fwrite per line keeps lines of several threads
  // apart.
  const std::string text = fmt::format("palpa: {}: {}", word_of(level_words, at), one_line(line));
  const std::string whole = shortened(text, longest_line) + '\n';
  std::fwrite(whole.data(), 1, whole.size(), stderr);
}

/// A hostile file may cause any number of different warnings.
constexpr std::size_t most_kept = 1000;

/// The warnings of one run of a program.
struct Warnings {
  struct Line {
    std::string text;
    std::uint64_t times = 0, told = 0;
  };
  std::mutex mutex;
  bool holding = false, counting = false;
  std::vector<Line> lines;
  std::unordered_map<std::string, std::size_t> index;  ///< of lines, by their text
};
Warnings& warnings() {
  static Warnings instance;
  return instance;
}

/// Counts `line`; whether it is to be written at once.
bool count(std::string_view line) {
  Warnings& w = warnings();
  const std::lock_guard lock(w.mutex);
  if (!w.counting) return true;
  const auto found = w.index.find(std::string(line));
  if (found != w.index.end()) {
    ++w.lines[found->second].times;
    return false;
  }
  if (w.lines.size() == most_kept) return false;
  w.index.emplace(line, w.lines.size());
  w.lines.push_back({std::string(line), 1, w.holding ? 0u : 1u});
  return !w.holding;
}

/// What has not been told yet, and is told from now on.
std::vector<std::string> untold() {
  Warnings& w = warnings();
  const std::lock_guard lock(w.mutex);
  w.holding = false;
  std::vector<std::string> texts;
  for (Warnings::Line& line : w.lines) {
    if (line.told == line.times) continue;
    line.told = line.times;
    texts.push_back(line.times == 1 ? line.text : fmt::format("{} ({} times)", line.text, line.times));
  }
  return texts;
}

void start_counting(bool holding) {
  Warnings& w = warnings();
  const std::lock_guard lock(w.mutex);
  w.holding = w.counting = holding;
  w.lines.clear();
  w.index.clear();
}

}  // namespace

void set_level(Level level) {
  threshold = level;
}
Level level() {
  return threshold;
}

void error(std::string_view line) {
  write(Level::error, line);
}
void warning(std::string_view line) {
  if (count(line)) write(Level::warning, line);
}
void info(std::string_view line) {
  write(Level::info, line);
}
void debug(std::string_view line) {
  write(Level::debug, line);
}

void hold_warnings() {
  start_counting(true);
}

void release_warnings() {
  for (const std::string& line : untold())
    write(Level::warning, line);
}

void drop_warnings() {
  start_counting(false);
}

}  // namespace palpa::log
