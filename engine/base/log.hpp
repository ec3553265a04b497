// One line per event on stderr. A succeeding command writes only warnings at the default level.
#pragma once

#include <optional>
#include <string_view>

namespace palpa::log {

enum class Level { quiet, error, warning, info, debug };

void set_level(Level level);
Level level();
/// "quiet", "error", "warning", "info" or "debug".
std::optional<Level> parse_level(std::string_view name);

/// Thread-safe; `line` carries no newline.
void error(std::string_view line);
void warning(std::string_view line);
void info(std::string_view line);
void debug(std::string_view line);

}  // namespace palpa::log
