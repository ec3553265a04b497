#include "array/resolution.hpp"

#include "array/drive.hpp"
#include "array/field/free_field.hpp"
#include "array/free_drives.hpp"
#include "array/solvers/gs_pat.hpp"

namespace palpa::array {

std::vector<FocusPair> unresolved_pairs(const Layout& layout, std::span<const SlotFocus> foci,
                                        const DriveOptions& options) {
  std::vector<FocusSource> sources;
  std::vector<std::size_t> numbers;
  for (std::size_t j = 0; j < foci.size(); ++j) {
    if (!drivable(foci[j])) continue;
    sources.push_back({foci[j].position, farthest_distance(layout, foci[j].position), 1});
    numbers.push_back(j);
  }
  std::vector<FocusPair> pairs;
  if (sources.size() < 2 || sources.size() > most_solved_foci) return pairs;
  FreeField free_field;
  Columns columns;
  transfer_of(layout, options, free_field).fill(sources, options.weighting, columns);
  FocusMatrix matrix;
  multiply(columns, matrix);
  for (std::size_t j = 0; j < sources.size(); ++j) {
    for (std::size_t k = j + 1; k < sources.size(); ++k) {
      if (const double part = heard_part(matrix, j, k); part >= gs_pat_crowded)
        pairs.push_back({numbers[j], numbers[k], part});
    }
  }
  return pairs;
}

}  // namespace palpa::array
