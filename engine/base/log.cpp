#include "base/log.hpp"

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cstdio>

namespace palpa::log {
namespace {

std::atomic<Level> threshold{Level::warning};
constexpr std::array<std::string_view, 5> names{"quiet", "error", "warning", "info", "debug"};

void write(Level at, std::string_view line) {
  if (at > threshold.load(std::memory_order_relaxed)) return;
  // One fwrite per line keeps lines of several threads apart.
  const std::string text = fmt::format("palpa: {}: {}\n", names[static_cast<std::size_t>(at)], line);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace

void set_level(Level level) { threshold = level; }
Level level() { return threshold; }

std::optional<Level> parse_level(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<Level>(i);
  }
  return std::nullopt;
}

void error(std::string_view line) { write(Level::error, line); }
void warning(std::string_view line) { write(Level::warning, line); }
void info(std::string_view line) { write(Level::info, line); }
void debug(std::string_view line) { write(Level::debug, line); }

}  // namespace palpa::log
