#include "study/files/counts_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/lines.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "study/files/trial.hpp"

namespace palpa::study {
namespace {

constexpr std::uint64_t most_bytes = 1 << 20;
constexpr std::uint64_t most_count = 1'000'000'000;
/// More are only counted to here.
constexpr std::size_t most_cells = 1000;

char separator_of(std::string_view line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

std::uint64_t count_in(std::string_view cell, const std::string& name, std::size_t line) {
  const std::optional<std::uint64_t> count = parse_whole<std::uint64_t>(cell);
  if (!count || *count > most_count) {
    throw bad_input(name, fmt::format("line {}: '{}' is not a count: give whole numbers of answers, 0 to {}", line,
                                      printable(cell, 40), most_count));
  }
  return *count;
}

std::vector<std::string> shapes_in(const std::vector<std::string>& header, std::size_t line, const std::string& name) {
  std::vector<std::string> shapes;
  for (std::size_t i = 1; i < header.size(); ++i) {
    const std::string& shape = header[i];
    // A file of another kind may be anything, so no message shows its bytes.
    if (shape.empty() || shape.size() > most_name)
      throw bad_input(name, fmt::format("line {}: name {} is not a name of 1 to {} letters", line, i, most_name));
    if (std::ranges::find(shapes, shape) != shapes.end())
      throw bad_input(name, fmt::format("line {}: name {} is there twice", line, i));
    shapes.push_back(shape);
  }
  if (shapes.size() < 2 || shapes.size() > most_shapes) {
    throw bad_input(name, fmt::format("line {}: has {} shapes, 2 to {} are needed: the line has the answers, such as "
                                      "actual,cube,prism",
                                      line, shapes.size(), most_shapes));
  }
  return shapes;
}

/// A line of the table as it stands in the file.
struct Row {
  std::size_t line = 0;  ///< in the file, from 1
  std::string shape;
  std::vector<std::string> cells;
};

std::vector<std::string> cells_in(std::string_view line, char separator) {
  std::vector<std::string> cells = plain_cells_of(line, separator, most_cells);
  while (cells.size() > 1 && cells.back().empty())
    cells.pop_back();
  return cells;
}

/// The separator of a first line such as "sep=;", which spreadsheets write.
std::optional<char> told_separator(std::string_view line) {
  if (line.starts_with('"') && line.ends_with('"') && line.size() > 1) line = line.substr(1, line.size() - 2);
  const bool tells =
      line.size() == 5 && (line.starts_with("sep=") || line.starts_with("Sep=") || line.starts_with("SEP="));
  return tells ? std::optional(line[4]) : std::nullopt;
}

/// Whether `sum` is that of the other numbers, of which at least one is not 0.
bool is_sum(std::uint64_t sum, std::uint64_t all) {
  return sum == all - sum;
}

/// Removes rows and columns that are sums of the others, as spreadsheets, R and pandas add them. Numbers decide, not
/// names: a column is left out if it is the sum of the others in each row, and not all 0; a row likewise. A name that
/// is that of a row and of a column must be a sum in both, and two shapes must be left, because equal counts of two
/// shapes look like sums.
void leave_out_sums(std::vector<std::string>& answers, std::vector<Row>& rows, CountsFile& file,
                    const std::string& name) {
  std::vector<std::vector<std::uint64_t>> counts;
  for (const Row& row : rows) {
    if (row.cells.size() != answers.size()) return;  // a fault that has a line of its own
    std::vector<std::uint64_t>& numbers = counts.emplace_back();
    for (const std::string& cell : row.cells)
      numbers.push_back(count_in(cell, name, row.line));
  }
  const auto sum_of_row = [&](std::size_t r) {
    return std::accumulate(counts[r].begin(), counts[r].end(), std::uint64_t{0});
  };
  const auto sum_of_column = [&](std::size_t c) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0},
                           [&](std::uint64_t sum, const auto& row) { return sum + row[c]; });
  };
  const auto column_is_sum = [&](std::size_t c) {
    bool sums = sum_of_column(c) > 0;
    for (std::size_t r = 0; r < rows.size(); ++r)
      sums = sums && is_sum(counts[r][c], sum_of_row(r));
    return sums;
  };
  const auto row_is_sum = [&](std::size_t r) {
    bool sums = sum_of_row(r) > 0;
    for (std::size_t c = 0; c < answers.size(); ++c)
      sums = sums && is_sum(counts[r][c], sum_of_column(c));
    return sums;
  };
  std::optional<std::size_t> column, row;
  for (std::size_t c = 0; c < answers.size(); ++c) {
    const auto same = std::ranges::find(rows, answers[c], &Row::shape);
    if (!column_is_sum(c) || (same != rows.end() && !row_is_sum(static_cast<std::size_t>(same - rows.begin()))))
      continue;
    column = c;
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto same = std::ranges::find(answers, rows[r].shape);
    if (!row_is_sum(r) || (same != answers.end() && column != same - answers.begin())) continue;
    row = r;
  }
  if (answers.size() - (column ? 1 : 0) < 2 || rows.size() - (row ? 1 : 0) < 2) return;
  if (column) {
    file.warnings.push_back(fmt::format("{}: the answer '{}' is the sum of the others and left out", name,
                                        printable(answers[*column], 40)));
    answers.erase(answers.begin() + static_cast<std::ptrdiff_t>(*column));
    for (Row& one : rows)
      one.cells.erase(one.cells.begin() + static_cast<std::ptrdiff_t>(*column));
  }
  if (row) {
    file.warnings.push_back(fmt::format("{}: line {}: '{}' is the sum of the other lines and left out", name,
                                        rows[*row].line, printable(rows[*row].shape, 40)));
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(*row));
  }
}

}  // namespace

CountsFile parse_counts(std::string_view text, const std::string& name) {
  Lines lines(text);
  std::string_view first = lines.next().value_or("");
  const std::optional<char> told = told_separator(first);
  if (told) first = lines.next().value_or("");
  const char separator = told.value_or(separator_of(first));
  std::vector<std::string> answers = shapes_in(cells_in(first, separator), told ? 2 : 1, name);
  CountsFile file;
  std::vector<Row> rows;
  while (const std::optional<std::string_view> line = lines.next()) {
    std::vector<std::string> cells = cells_in(*line, separator);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (lines.cut())
      file.warnings.push_back(
          fmt::format("{}: line {} has no end: check that the file is complete", name, lines.number()));
    if (cells.size() != answers.size() + 1) {
      throw bad_input(
          name, fmt::format("line {}: {} where line {} has {}", lines.number(), counted(cells.size() - 1, "count"),
                            told ? 2 : 1, counted(answers.size(), "answer")));
    }
    Row& row = rows.emplace_back(Row{.line = lines.number(), .shape = std::move(cells[0]), .cells = {}});
    row.cells.assign(std::make_move_iterator(cells.begin() + 1), std::make_move_iterator(cells.end()));
  }
  leave_out_sums(answers, rows, file, name);
  file.table = Confusion(std::move(answers));
  Confusion& table = file.table;
  std::vector<bool> there(table.size(), false);
  for (const Row& one : rows) {
    const auto found = std::ranges::find(table.shapes, one.shape);
    if (found == table.shapes.end()) {
      throw bad_input(name, fmt::format("line {}: the shape '{}' is not among the answers {}", one.line,
                                        printable(one.shape, 40), fmt::join(table.shapes, ", ")));
    }
    const auto row = static_cast<std::size_t>(found - table.shapes.begin());
    if (there[row])
      throw bad_input(name, fmt::format("line {}: shape '{}' already has a line", one.line, printable(one.shape, 40)));
    there[row] = true;
    for (std::size_t j = 0; j < table.size(); ++j)
      table.at(row, j) = count_in(one.cells[j], name, one.line);
  }
  if (const auto missing = std::ranges::find(there, false); missing != there.end()) {
    const auto shape = static_cast<std::size_t>(missing - there.begin());
    throw bad_input(name, fmt::format("has no line of the shape '{}'", printable(table.shapes[shape], 40)));
  }
  if (table.total() == 0) throw bad_input(name, "all counts are 0");
  if (const std::uint64_t line = line_that_is_not_utf8(text); line != 0)
    file.warnings.push_back(
        fmt::format("{}: line {} has bytes that are not UTF-8: save the table as UTF-8", name, line));
  return file;
}

CountsFile read_counts(const std::filesystem::path& file) {
  return parse_counts(read_text_file(file, most_bytes), file.string());
}

}  // namespace palpa::study
