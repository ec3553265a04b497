// Another program's numbers (levitate, in ../shared/data/acoustics-levitate): the board openmpd with a focus at
// (0, 0, 0.15), at 343 m/s.
#pragma once

#include <filesystem>
#include <vector>

#include "array/layouts/layout.hpp"
#include "support/csv.hpp"
#include "support/shared_data.hpp"

namespace palpa::array {

/// Its phases, in the layout's order.
inline std::vector<double> levitate_phases(const std::filesystem::path& folder, const Layout& layout) {
  const auto positions = test::read_csv(folder / "array16x16_positions.csv"),
             phases = test::read_csv(folder / "phases_f0.csv");
  std::vector<double> found;
  for (const Transducer& t : layout.transducers) {
    for (std::size_t row = 0; row < positions.size(); ++row) {
      const Vec3 place(positions[row][0], positions[row][1], positions[row][2]);
      if (glm::distance(t.position, place) < 1e-6) found.push_back(phases.at(row)[0]);
    }
  }
  EXPECT_EQ(found.size(), layout.transducers.size());
  return found;
}

}  // namespace palpa::array
