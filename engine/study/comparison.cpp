#include "study/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "study/by_method.hpp"
#include "study/files/counts_file.hpp"
#include "study/files/results_file.hpp"
#include "study/files/study_folder.hpp"
#include "study/tables/paper.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> sorted(std::vector<std::string> names) {
  std::ranges::sort(names);
  return names;
}

}  // namespace

Comparison compare_tables(std::vector<NamedTable> tables) {
  Comparison comparison;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const auto same = [&](const NamedTable& other) {
      return sorted(other.table.shapes) == sorted(tables[i].table.shapes);
    };
    const auto first = std::ranges::find_if(tables, same);
    const Confusion table = in_order(tables[i].table, first->table.shapes).value();
    comparison.tables.push_back(measure(tables[i].name, table));
    for (std::size_t j = 0; j < i; ++j) {
      const Measures& other = comparison.tables[j];
      if (other.table.shapes == table.shapes) {
        comparison.pairs.push_back({j, i, compare(other.table, table)});
      } else {
        comparison.not_compared.push_back(
            fmt::format("{} ({}) and {} ({}) have different shapes, so they are not compared", other.name,
                        fmt::join(other.table.shapes, ", "), tables[i].name, fmt::join(table.shapes, ", ")));
      }
    }
  }
  return comparison;
}

std::vector<NamedTable> tables_of(const std::string& source, std::vector<std::string>& left_out) {
  std::error_code fault;
  const bool exists = fs::exists(source, fault);
  if (source == "paper" && !exists)
    return {{"paper: single-focus", paper_single_focus()}, {"paper: cross-section", paper_cross_section()}};
  std::vector<NamedTable> tables;
  if (fs::is_directory(source, fault)) {
    const std::string folders[]{source};
    const Study study = read_study(folders);
    left_out.insert(left_out.end(), study.left_out.begin(), study.left_out.end());
    const Results results = results_by_method(study, 0);
    for (const MethodResult& method : results.methods)
      tables.push_back({fmt::format("{}: {}", source, method.pooled.name), method.pooled.table});
  } else if (fs::path(source).extension() == ".json") {
    for (auto& [name, table] : read_results(source, left_out))
      tables.push_back({fmt::format("{}: {}", source, name), std::move(table)});
  } else {
    CountsFile file = read_counts(source);
    left_out.insert(left_out.end(), file.warnings.begin(), file.warnings.end());
    tables.push_back({source, std::move(file.table)});
  }
  return tables;
}

}  // namespace palpa::study
