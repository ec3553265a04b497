// Text for messages: counts of things, and text from outside made safe. Names and messages may come from any file, so
// they must not break a line, control a terminal or flood it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpa {

/// Length of the well-formed UTF-8 character at the front of `text`, 0 if there is none.
std::size_t utf8_length(std::string_view text);
/// The character with this code point.
std::string utf8(std::uint32_t code);
/// The first line, from 1, with bytes that are not UTF-8; 0 if there is none.
std::uint64_t line_that_is_not_utf8(std::string_view text);

/// `text` with invisible and controlling characters escaped: control characters as \n or \x1b, characters that change
/// the writing direction or break lines as \u202e, bytes that are not UTF-8 as \xff. If the result exceeds `most`
/// bytes, it is cut at a whole character or escape and followed by "...".
std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

/// A foreign message in the style of palpa's own: printable, on one line (line breaks and tabs become spaces), and
/// without a full stop, space or line break at its end.
std::string one_line(std::string_view message, std::size_t most = std::string_view::npos);

/// `text` cut to at most `most` bytes: "..." replaces the middle of a longer one. A message begins with what is wrong
/// and ends with what would be right, so both are kept.
std::string shortened(const std::string& text, std::size_t most);

/// "1 frame", "2 frames"; "0 foci", "3 vertices", "2 bodies". `one` is the word or words for one thing.
std::string counted(std::uint64_t n, std::string_view one);
/// The same word without the number: "frame" for 1, otherwise "frames".
std::string plural(std::uint64_t n, std::string_view one);
/// "node 3 is", "node 3 and 1 other are", "node 3 and 2 others are": `count` things, the first of which has a name.
std::string first_is(std::string_view first, std::uint64_t count);

/// A text as a cell of a CSV file, quoted if it would otherwise be split.
std::string csv_cell(const std::string& text);

}  // namespace palpa
