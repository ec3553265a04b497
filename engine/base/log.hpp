// One line per event on stderr. A succeeding command writes only warnings at the default level.
#pragma once

#include <string_view>

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

/// From now on warnings are kept instead of written: a program that turns out to fail says only why, one that succeeds
/// releases them. Long work releases them before it begins. The same warning is then told once, and how often it came.
void hold_warnings();
/// Writes what has not been written, in order, and ends keeping; again at the end, for what came again meanwhile.
void release_warnings();
/// Forgets what was kept and ends keeping and counting.
void drop_warnings();

}  // namespace palpa::log
