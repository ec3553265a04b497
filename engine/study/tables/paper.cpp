#include "study/tables/paper.hpp"

namespace palpa::study {

std::vector<std::string> paper_shapes() {
  return {"cube", "semi-sphere", "pyramid", "prism"};
}

Confusion paper_single_focus() {
  Confusion table(paper_shapes());
  table.counts = {50, 30, 9, 11, 23, 42, 16, 19, 13, 37, 26, 24, 17, 18, 27, 38};
  return table;
}

Confusion paper_cross_section() {
  Confusion table(paper_shapes());
  table.counts = {74, 14, 2, 10, 5, 59, 11, 25, 2, 30, 65, 3, 14, 10, 13, 63};
  return table;
}

}  // namespace palpa::study
