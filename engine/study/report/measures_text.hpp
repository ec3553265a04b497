// A confusion matrix and its measures as lines of text, and as parts of a page.
#pragma once

#include <string>
#include <vector>

#include "study/pages/html.hpp"
#include "study/tables/measures.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::study {

/// The table in shares, as in the paper, and its measures; indented by two spaces.
std::string measures_text(const Measures& measures);

/// A figure of the table, and tables of its measures.
void add_measures(HtmlPage& page, const Measures& measures);

/// Two tables beside each other, with the names of the tables.
void add_difference(HtmlPage& page, const std::string& a, const std::string& b, const std::vector<std::string>& shapes,
                    const TwoTables& tables);

}  // namespace palpa::study
