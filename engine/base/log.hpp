// One line per event on stderr. A successful command writes only warnings at the default level.
//
// Logging blocks while stderr is a pipe that nobody reads, or a terminal that Ctrl-S has stopped. Code that must not
// block, because it has an array to silence, logs while a Relay lives.
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

/// Thread-safe. Unprintable characters are escaped, line breaks become spaces, and a line of more than 500 bytes loses
/// its middle.
void error(std::string_view line);
void warning(std::string_view line);
void info(std::string_view line);
void debug(std::string_view line);
/// A warning that is never held back, and is also written at the level error. It says what the program waits for, which
/// the user who waits for the program needs to know.
void at_once(std::string_view line);

/// From now on, warnings are held instead of written. A program that fails then prints only the reason, and one that
/// succeeds releases them. Long work releases them before it begins. A repeated warning is written once, with its
/// count. After the thousandth different warning only the number of further ones is written.
void hold_warnings();
/// Writes the held warnings in order and stops holding. Called again at the end, it writes how often they were repeated
/// meanwhile.
void release_warnings();
/// Discards the held warnings and stops holding and counting.
void drop_warnings();

/// A line for the user of a program with a window: a line as it is logged, or a held warning when it is released.
struct Line {
  Level level = Level::info;
  std::string text;
};

/// Keeps the newest lines, down to info at any log level, for display. Only one may exist at a time.
class Tail {
 public:
  static constexpr std::size_t most = 500;
  Tail();
  ~Tail();
  Tail(const Tail&) = delete;
  Tail& operator=(const Tail&) = delete;

  /// The lines since the last call, oldest first; at most `most`.
  std::vector<Line> take();
};

/// Text that a terminal shows until other output replaces it, such as a progress bar. It is not a log line and is not
/// kept. While a Relay lives, it is skipped if any other output still waits, and false is returned.
bool draw(std::string_view text);

/// While one lives, a separate thread writes the log, so that no logging thread waits for a slow reader or a disk. At
/// most 64 KiB wait for a slow reader. Further lines are dropped, and one line reports their number as soon as there is
/// room for it. Several relays act as one.
class Relay {
 public:
  /// How long the destructor of the last relay waits for a reader of unwritten output. It waits
  /// StreamWriter::disk_patience_s for a disk.
  static constexpr double patience_s = 0.2;
  Relay();
  ~Relay();
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  /// The number of dropped lines that were not reported yet.
  static std::uint64_t left_out();
};

}  // namespace palpa::log
