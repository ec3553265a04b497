// A barrier that is missing after one of the array's kernels is seen. solve_even_phases is not tried: the host seeks
// the phases of these foci.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "backends.hpp"
#include "support/barriers.hpp"
#include "support/thrown.hpp"

namespace palpa::array {
namespace {

/// One slot of each of these numbers of foci.
std::vector<std::vector<SlotFocus>> slots_of(const std::vector<int>& sizes) {
  std::vector<std::vector<SlotFocus>> slots;
  for (const int size : sizes) {
    slots.emplace_back();
    for (int i = 0; i < size; ++i)
      slots.back().push_back({{0.02 * (i % 8), 0.02 * (i / 8), 0.15}, i % 2 == 0 ? 1.0F : 0.5F, {}});
  }
  return slots;
}

// Unequal gains: the device solves all of these slots. What a kernel writes, the next one of these slots reads or
// writes.
TEST(MissingBarriers, AreSeenAfterEachKernelOfTheArray) {
  const Layout layout = load_layout("paper");
  constexpr int few = 3, many = 40;
  const struct {
    const char* kernel;
    std::vector<int> slots;
    DriveOptions options;
  } cases[] = {{"drive_focus", {1, few}, with(Solver::naive)},
               {"drive_sum", {few}, with(Solver::naive)},
               {"drive_weighted", {few}, with(Solver::gs_pat)},
               {"solve_diagonal", {few}, with(Solver::gs_pat)},
               {"solve_mirrored", {many}, with(Solver::gs_pat)},
               {"solve_weights_few", {few}, with(Solver::gs_pat)},
               {"solve_weights", {many}, with(Solver::gs_pat)},
               {"solve_eigenvalue", {many}, with(Solver::eigenvalue)},
               {"solve_refine", {many}, with(Solver::gs_pat, Constraint::uniform)},
               {"solve_greedy", {few}, with(Solver::greedy)}};
  for (const auto& [kernel, sizes, options] : cases) {
    const auto slots = slots_of(sizes);
    const auto drive = [&] { backends[1].drives(layout, slots, options); };
    EXPECT_EQ(test::error_of(drive, Exit::failed), "") << kernel << " with its barrier";
    const test::NoBarrierAfter none(kernel);
    EXPECT_CONTAINS(test::error_of(drive, Exit::failed), std::string("which ") + kernel + " ");
  }
}

}  // namespace
}  // namespace palpa::array
