// One line per event on stderr. A succeeding command writes only warnings at the default level.
//
// Whoever writes to a pipe that nobody reads, or to a terminal that Ctrl-S has stopped, waits. Who must not, since it
// has an array to silence, logs while a Relay lives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/words.hpp"

namespace palpa::log {

enum class Level { quiet, error, warning, info, debug };
inline constexpr Word<Level> level_words[] = {{"quiet", Level::quiet},
                                              {"error", Level::error},
                                              {"warning", Level::warning},
                                              {"info", Level::info},
                                              {"debug", Level::debug}};

void set_level(Level level);
Level level();

/// Thread-safe. What cannot be printed is escaped, line breaks are spaces, and a line of more than 500 bytes loses its
/// middle.
void error(std::string_view line);
void warning(std::string_view line);
void info(std::string_view line);
void debug(std::string_view line);
/// A warning that is not kept back: what the program waits for, which whoever waits for the program has to know.
void at_once(std::string_view line);

/// From now on warnings are kept instead of written: a program that turns out to fail says only why, one that succeeds
/// releases them. Long work releases them before it begins. The same warning is then told once, and how often it came;
/// of those after the thousandth only how many there were.
void hold_warnings();
/// Writes what has not been written, in order, and ends keeping; again at the end, for what came again meanwhile.
void release_warnings();
/// Forgets what was kept and ends keeping and counting.
void drop_warnings();

/// What is told to people while a program with a window runs: lines as they are logged, kept warnings when they are
/// released.
struct Line {
  Level level = Level::info;
  std::string text;
};

/// Keeps the newest lines, down to info whatever the level, for whoever shows them. One at a time.
class Tail {
 public:
  static constexpr std::size_t most = 500;
  Tail();
  ~Tail();
  Tail(const Tail&) = delete;
  Tail& operator=(const Tail&) = delete;

  /// Those since the last call, oldest first; at most `most`.
  std::vector<Line> take();
};

/// What a terminal shows until something else takes its place, such as a progress bar: no line, and not kept. While a
/// Relay lives it is left out where anything else still waits; false then.
bool draw(std::string_view text);

/// While one lives, a thread of its own writes what is logged, and nobody who logs waits for whoever reads it, or for a
/// disk. Of a reader that is too slow 64 KiB wait; lines beyond are left out, and one line says how many as soon as
/// there is room for it. Several are as one.
class Relay {
 public:
  /// How long the last one's end waits for what has not been written yet.
  static constexpr double patience_s = 0.2;
  Relay();
  ~Relay();
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  /// Lines that were left out and not told of yet.
  static std::uint64_t left_out();
};

}  // namespace palpa::log
