#include "study/files/counts_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
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

std::vector<std::string> shapes_in(const std::vector<std::string>& header, const std::string& name) {
  std::vector<std::string> shapes;
  for (std::size_t i = 1; i < header.size(); ++i) {
    const std::string& shape = header[i];
    // A file of another kind may be anything, so no message shows its bytes.
    if (shape.empty() || shape.size() > most_name)
      throw bad_input(name, fmt::format("line 1: name {} is not a name of 1 to {} letters", i, most_name));
    if (std::ranges::find(shapes, shape) != shapes.end())
      throw bad_input(name, fmt::format("line 1: name {} is there twice", i));
    shapes.push_back(shape);
  }
  if (shapes.size() < 2 || shapes.size() > most_shapes) {
    throw bad_input(name, fmt::format("line 1: has {} shapes, 2 to {} are needed: the line has the answers, such as "
                                      "actual,cube,prism",
                                      shapes.size(), most_shapes));
  }
  return shapes;
}

}  // namespace

CountsFile parse_counts(std::string_view text, const std::string& name) {
  Lines lines(text);
  const std::string_view first = lines.next().value_or("");
  const char separator = separator_of(first);
  CountsFile file{.table = Confusion(shapes_in(plain_cells_of(first, separator, most_cells), name))};
  Confusion& table = file.table;
  std::vector<bool> there(table.size(), false);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) continue;
    const std::vector<std::string> cells = plain_cells_of(*line, separator, most_cells);
    if (cells.size() != table.size() + 1) {
      throw bad_input(name, fmt::format("line {}: {} where line 1 has {}", lines.number(),
                                        counted(cells.size() - 1, "count"), counted(table.size(), "answer")));
    }
    const std::string& shape = cells[0];
    const auto found = std::ranges::find(table.shapes, shape);
    if (found == table.shapes.end()) {
      throw bad_input(name, fmt::format("line {}: the shape '{}' is not among the answers {}", lines.number(),
                                        printable(shape, 40), fmt::join(table.shapes, ", ")));
    }
    const auto row = static_cast<std::size_t>(found - table.shapes.begin());
    if (there[row])
      throw bad_input(name,
                      fmt::format("line {}: shape '{}' already has a line", lines.number(), printable(shape, 40)));
    there[row] = true;
    for (std::size_t j = 0; j < table.size(); ++j)
      table.at(row, j) = count_in(cells[j + 1], name, lines.number());
    if (lines.cut())
      file.warning = fmt::format("{}: line {} has no end: check that the file is complete", name, lines.number());
  }
  if (const auto missing = std::ranges::find(there, false); missing != there.end()) {
    const auto shape = static_cast<std::size_t>(missing - there.begin());
    throw bad_input(name, fmt::format("has no line of the shape '{}'", printable(table.shapes[shape], 40)));
  }
  if (table.total() == 0) throw bad_input(name, "all counts are 0");
  if (const std::uint64_t line = line_that_is_not_utf8(text); line != 0 && file.warning.empty())
    file.warning = fmt::format("{}: line {} has bytes that are not UTF-8: save the table as UTF-8", name, line);
  return file;
}

CountsFile read_counts(const std::filesystem::path& file) {
  return parse_counts(read_text_file(file, most_bytes), file.string());
}

}  // namespace palpa::study
