// Text from outside, made fit for a message. Names and messages may come from any file: they must neither break a line,
// nor steer a terminal, nor flood it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpa {

/// `text` with `instead` for every control character. Of more than `most` bytes only the first are shown, cut between
/// two UTF-8 characters and followed by "...".
std::string printable(std::string_view text, std::size_t most = std::string_view::npos, char instead = '?');

/// A message of somebody else as palpa's own are: printable, on one line, without the full stop, space or line break at
/// its end.
std::string one_line(std::string_view message, std::size_t most = std::string_view::npos);

}  // namespace palpa
