#include "study/files/results_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/text.hpp"
#include "study/files/trial.hpp"

namespace palpa::study {
namespace {

using nlohmann::json;

constexpr std::uint64_t most_bytes = 64 << 20, most_count = 1'000'000'000;
constexpr std::size_t most_line = 1000, most_compared = 100;

[[noreturn]] void refuse(const std::string& file, const std::string& fault) {
  throw bad_input(file, fmt::format("{}: a JSON file of palpa study analyse or compare is needed", fault));
}

std::vector<std::string> shapes_in(const json& document, const std::string& file) {
  const auto found = document.find("shapes");
  if (found == document.end() || !found->is_array() || found->size() < 2 || found->size() > most_shapes)
    refuse(file, fmt::format("\"shapes\" is not a list of 2 to {} names", most_shapes));
  std::vector<std::string> shapes;
  for (const json& shape : *found) {
    if (!shape.is_string()) refuse(file, "\"shapes\" has something that is not a name");
    shapes.push_back(shape.get<std::string>());
    if (std::ranges::count(shapes, shapes.back()) > 1) refuse(file, "\"shapes\" has a name twice");
  }
  return shapes;
}

Confusion table_in(const json& method, const std::vector<std::string>& shapes, const std::string& file) {
  Confusion table(shapes);
  const auto counts = method.find("counts");
  if (counts == method.end() || !counts->is_array() || counts->size() != shapes.size())
    refuse(file, fmt::format("\"counts\" does not have {} rows", shapes.size()));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const json& row = (*counts)[i];
    if (!row.is_array() || row.size() != shapes.size())
      refuse(file, fmt::format("row {} of \"counts\" does not have {} counts", i + 1, shapes.size()));
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      if (!row[j].is_number_unsigned() || row[j].get<std::uint64_t>() > most_count)
        refuse(file, fmt::format("row {} of \"counts\" has something that is not a count", i + 1));
      table.at(i, j) = row[j].get<std::uint64_t>();
    }
  }
  if (table.total() == 0) refuse(file, "all \"counts\" are 0");
  return table;
}

}  // namespace

std::vector<std::pair<std::string, Confusion>> read_results(const std::filesystem::path& path,
                                                            std::vector<std::string>& left_out) {
  const std::string file = path.string();
  const json document = json::parse(read_text_file(path, most_bytes), nullptr, false);
  const json kind = document.is_object() ? document.value("kind", json()) : json();
  // Earlier versions wrote no kind for a table of counts.
  const bool compared = document.is_object() && document.contains("tables");
  if (kind != results_kind && !(compared && (kind == comparison_kind || kind.is_null())))
    refuse(file, "\"kind\" is not that of such a file");
  // A study has the same shapes in all tables.
  const std::vector<std::string> shapes = compared ? std::vector<std::string>() : shapes_in(document, file);
  const char* const key = compared ? "tables" : "methods";
  const std::size_t most = compared ? most_compared : most_methods;
  const auto list = document.find(key);
  if (list == document.end() || !list->is_array() || list->empty() || list->size() > most)
    refuse(file, fmt::format("\"{}\" is not a list of 1 to {} tables", key, most));
  std::vector<std::pair<std::string, Confusion>> tables;
  for (const json& entry : *list) {
    const json name = entry.is_object() ? entry.value("name", json()) : json();
    if (!name.is_string()) refuse(file, fmt::format("\"{}\" has something without a \"name\"", key));
    tables.emplace_back(name.get<std::string>(), table_in(entry, compared ? shapes_in(entry, file) : shapes, file));
  }
  for (const json& line : document.value("left_out", json::array())) {
    if (line.is_string()) left_out.push_back(printable(line.get<std::string>(), most_line));
  }
  return tables;
}

}  // namespace palpa::study
