#include "base/files/lines.hpp"

#include <algorithm>
#include <utility>

#include "base/files/input_file.hpp"

namespace palpa {
namespace {

std::string_view without_spaces(std::string_view cell) {
  const std::size_t begin = std::min(cell.find_first_not_of(' '), cell.size());
  cell.remove_prefix(begin);
  return cell.substr(0, cell.find_last_not_of(' ') + 1);
}

/// A cell in quotes at the beginning of `line`, and the text that follows it; nothing if the quotes do not end before a
/// separator.
std::optional<std::pair<std::string, std::string_view>> quoted_cell(std::string_view line, char separator) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  if (!line.starts_with('"')) return std::nullopt;
  std::string cell;
  for (std::size_t at = 1; at < line.size(); ++at) {
    if (line[at] != '"') {
      cell += line[at];
    } else if (at + 1 < line.size() && line[at + 1] == '"') {
      cell += line[at++];
    } else {
      std::string_view rest = line.substr(at + 1);
      rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
      if (!rest.empty() && rest.front() != separator) return std::nullopt;
      return std::pair(std::string(without_spaces(cell)), rest);
    }
  }
  return std::nullopt;
}

}  // namespace

Lines::Lines(std::string_view text) : rest_(text.substr(mark_of(text))) {}

std::optional<std::string_view> Lines::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find('\n');
  cut_ = end == std::string_view::npos;
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(cut_ ? rest_.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++number_;
  return line;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t end = line.find(separator);
    cells.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string> plain_cells_of(std::string_view line, char separator, std::size_t most) {
  std::vector<std::string> cells;
  while (cells.size() <= most) {
    if (auto quoted = quoted_cell(line, separator)) {
      cells.push_back(std::move(quoted->first));
      line = quoted->second;
    } else {
      const std::size_t end = std::min(line.find(separator), line.size());
      cells.emplace_back(without_spaces(line.substr(0, end)));
      line.remove_prefix(end);
    }
    if (line.empty()) break;
    line.remove_prefix(1);
  }
  return cells;
}

}  // namespace palpa
