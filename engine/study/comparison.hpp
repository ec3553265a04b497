// Results of any kind beside each other: studies, tables of counts, results of palpa study analyse, the paper's tables.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/tables/measures.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::study {

/// A confusion matrix and where it comes from.
struct NamedTable {
  std::string name{};
  Confusion table{};
};

struct ComparedPair {
  std::size_t a = 0, b = 0;  ///< places in Comparison::tables, a < b
  TwoTables tables{};
};

struct Comparison {
  std::vector<Measures> tables{};
  std::vector<ComparedPair> pairs{};        ///< of tables with the same shapes
  std::vector<std::string> not_compared{};  ///< a line for each pair with other shapes
};
/// Shapes may be in another order: all tables get the order of the first that has the same shapes.
Comparison compare_tables(std::vector<NamedTable> tables);

/// The tables of one source: a folder of a study, one table per method; a .json of palpa study analyse or compare, its
/// tables; the word "paper"; any other file as counts. Appends what was left out. Throws bad_input as the readers do.
std::vector<NamedTable> tables_of(const std::string& source, std::vector<std::string>& left_out);

}  // namespace palpa::study
