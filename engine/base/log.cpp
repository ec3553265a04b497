#include "base/log.hpp"

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/text.hpp"

namespace palpa::log {
namespace {

std::atomic<Level> threshold{Level::warning};
constexpr std::array<std::string_view, 5> names{"quiet", "error", "warning", "info", "debug"};

/// A hostile file may cause any number of warnings.
constexpr std::size_t most_held = 1000;

struct Held {
  std::mutex mutex;
  bool holding = false;
  std::vector<std::string> lines;
};
Held& held() {
  static Held instance;
  return instance;
}

/// Whether `line` was kept.
bool keep(std::string_view line) {
  Held& h = held();
  const std::lock_guard lock(h.mutex);
  if (h.holding && h.lines.size() < most_held) h.lines.emplace_back(line);
  return h.holding;
}

std::vector<std::string> end_holding() {
  Held& h = held();
  const std::lock_guard lock(h.mutex);
  h.holding = false;
  return std::exchange(h.lines, {});
}

void write(Level at, std::string_view line) {
  if (at > threshold.load(std::memory_order_relaxed)) return;
  // One fwrite per line keeps lines of several threads apart.
  // Names from files may hold anything; an event stays one line.
  const std::string text =
      fmt::format("palpa: {}: {}\n", names[static_cast<std::size_t>(at)], printable(line, std::string_view::npos, ' '));
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace

void set_level(Level level) {
  threshold = level;
}
Level level() {
  return threshold;
}

std::optional<Level> parse_level(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<Level>(i);
  }
  return std::nullopt;
}

void error(std::string_view line) {
  write(Level::error, line);
}
void warning(std::string_view line) {
  if (!keep(line)) write(Level::warning, line);
}
void info(std::string_view line) {
  write(Level::info, line);
}
void debug(std::string_view line) {
  write(Level::debug, line);
}

void hold_warnings() {
  Held& h = held();
  const std::lock_guard lock(h.mutex);
  h.holding = true;
}

void release_warnings() {
  for (const std::string& line : end_holding())
    write(Level::warning, line);
}

void drop_warnings() {
  end_holding();
}

}  // namespace palpa::log
