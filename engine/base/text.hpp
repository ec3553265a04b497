// Text from outside, made fit for a message. Names and messages may come from any file: they must neither break a line,
// nor steer a terminal, nor flood it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpa {

/// Length of the well-formed UTF-8 character at the front of `text`, 0 if there is none.
std::size_t utf8_length(std::string_view text);

/// `text` with escapes for what cannot be seen or steers what is: control characters as \n or \x1b, characters that
/// turn the direction of writing or break lines as \u202e, bytes that are no UTF-8 as \xff. Where that takes more than
/// `most` bytes only the first are shown, whole characters and whole escapes, followed by "...".
std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

/// A message of somebody else as palpa's own are: printable, on one line (line breaks and tabs are spaces), without the
/// full stop, space or line break at its end.
std::string one_line(std::string_view message, std::size_t most = std::string_view::npos);

/// `text` of at most `most` bytes: a longer one loses its middle, for "...". What is wrong stands at the beginning of a
/// message, what would be right at its end.
std::string shortened(const std::string& text, std::size_t most);

}  // namespace palpa
