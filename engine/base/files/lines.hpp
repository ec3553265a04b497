// Lines and cells of tables of text.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpa {

/// Goes through a text line by line.
class Lines {
 public:
  explicit Lines(std::string_view text);

  /// The next line, without its end (LF or CRLF). Empty after the last.
  std::optional<std::string_view> next();
  /// The number of the line that next() returned last, from 1.
  std::size_t number() const { return number_; }
  /// Whether the line that next() returned last had no end: the file was cut within it, or ends without one.
  bool cut() const { return cut_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
  bool cut_ = false;
};

/// The cells between separators, as they are.
std::vector<std::string_view> cells_of(std::string_view line, char separator);

/// The cells as a spreadsheet means them: without spaces around them, and without quotes, within which a separator is a
/// letter and two quotes are one. A quote that does not end is a letter. At most `most` + 1 cells: further ones are not
/// listed.
std::vector<std::string> plain_cells_of(std::string_view line, char separator, std::size_t most);

}  // namespace palpa
