// The solvers of the literature, which palpa has to compare: what their authors promise, and no more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/solvers/complex_system.hpp"
#include "array/transducer_drive.hpp"
#include "backends.hpp"

namespace palpa::array {
namespace {

/// Foci at least 10 mm apart.
std::vector<SlotFocus> random_foci(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<double> place(-0.03, 0.03);
  std::vector<SlotFocus> foci;
  while (foci.size() < count) {
    const double x = place(random), y = place(random);
    const Vec3 next(x, y, 0.15);
    if (std::ranges::all_of(foci, [&](const SlotFocus& other) { return glm::length(other.position - next) >= 10e-3; }))
      foci.push_back({next});
  }
  return foci;
}

class Literature : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Both, Literature, testing::ValuesIn(backends), backend_name);

TEST_P(Literature, EigenvalueFociAreEvenWhereAmplitudesAreInProportion) {
  const Layout layout = load_layout("openmpd");
  std::mt19937 random(1);
  double naive = 0, solved = 0;
  for (int set = 0; set < 10; ++set) {
    const std::vector<SlotFocus> foci = random_foci(random, 5);
    const auto heard = [&](Solver solver, Constraint constraint) {
      return acoustics::pressure_at_foci(layout, GetParam().drive(layout, foci, with(solver, constraint)), foci);
    };
    EXPECT_GE(heard(Solver::eigenvalue, Constraint::normalise).evenness, 0.95) << set;
    EXPECT_GE(heard(Solver::eigenvalue, Constraint::uniform).evenness, 0.6) << set;
    naive += heard(Solver::naive, Constraint::uniform).mean;
    solved += heard(Solver::eigenvalue, Constraint::uniform).mean;
  }
  EXPECT_GT(solved, 1.03 * naive);
  const std::vector<SlotFocus> unequal{{{0, 0, 0.15}, 1}, {{0.02, 0, 0.15}, 0.5F}, {{0, -0.02, 0.15}, 0.8F}};
  const Drive drive = GetParam().drive(layout, unequal, with(Solver::eigenvalue));
  EXPECT_GE(acoustics::pressure_at_foci(layout, drive, unequal).evenness, 0.95);
}

TEST_P(Literature, BackPropagationIsLouderThanTheSumOfTheFoci) {
  const Layout layout = load_layout("openmpd");
  std::mt19937 random(2);
  double naive = 0, propagated = 0;
  for (int set = 0; set < 5; ++set) {
    const std::vector<SlotFocus> foci = random_foci(random, 5);
    for (const Constraint constraint : constraints) {
      const auto mean = [&](Solver solver) {
        return acoustics::pressure_at_foci(layout, GetParam().drive(layout, foci, with(solver, constraint)), foci).mean;
      };
      naive += mean(Solver::naive);
      propagated += mean(Solver::back_propagation);
    }
  }
  EXPECT_GT(propagated, 1.03 * naive);
}

// Both sides take the same steps, so the sound at each focus is the same, also where the array does not resolve foci,
// and for slots of one, of many and of too many foci in a batch.
TEST(LiteratureSolvers, DeviceAndTwinAgree) {
  const Layout layout = load_layout("openmpd");
  std::mt19937 random(4);
  std::vector<std::vector<SlotFocus>> slots;
  for (const std::size_t count : {2u, 3u, 5u, 10u, 11u, 17u}) {
    slots.push_back(random_foci(random, count));
    slots.push_back(slots.back());
    for (std::size_t j = 1; j < count; ++j)  // not resolved; gains differ
      slots.back()[j] = {Vec3(2e-3 * static_cast<double>(j), 0, 0.15), 0.3F + 0.04F * static_cast<float>(j)};
  }
  slots.push_back({slots[0][0]});
  slots.push_back({});
  for (const std::size_t count : {64u, 65u}) {
    std::vector<SlotFocus>& many = slots.emplace_back();
    for (std::size_t j = 0; j < count; ++j)
      many.push_back({Vec3(-0.035 + 0.01 * static_cast<double>(j % 8), -0.04 + 0.01 * static_cast<double>(j / 8), 0.15),
                      j % 3 == 0 ? 0.5F : 1});
  }
  for (const Solver solver : {Solver::eigenvalue, Solver::back_propagation}) {
    for (const Constraint constraint : constraints) {
      const DriveOptions options = with(solver, constraint);
      const auto twin = backends[0].drives(layout, slots, options), device = backends[1].drives(layout, slots, options);
      for (std::size_t s = 0; s < slots.size(); ++s) {
        if (slots[s].empty()) continue;
        const std::vector<double> expected = acoustics::pressure_at_foci(layout, twin[s], slots[s]).pascals,
                                  found = acoustics::pressure_at_foci(layout, device[s], slots[s]).pascals;
        const double loudest = *std::ranges::max_element(expected);
        for (std::size_t j = 0; j < expected.size(); ++j) {
          EXPECT_NEAR(found[j], expected[j], 0.01 * loudest)
              << static_cast<int>(solver) << " " << word_of(constraint_words, constraint) << " " << s;
        }
      }
    }
  }
}

TEST(ComplexSystem, IsSolved) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  const auto number = [&] {
    const double re = any(random), im = any(random);
    return std::complex<double>(re, im);
  };
  for (const std::size_t rows : {1u, 2u, 7u, 20u}) {
    std::vector<std::complex<double>> system(rows * rows), expected(rows), rest(rows);
    std::ranges::generate(system, number);
    system[0] = 0;  // the first pivot is another row's
    if (rows == 1) system[0] = 2;
    std::ranges::generate(expected, number);
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < rows; ++j)
        rest[i] += system[i * rows + j] * expected[j];
    }
    solve_complex(system, rest);
    for (std::size_t i = 0; i < rows; ++i)
      EXPECT_LT(std::abs(rest[i] - expected[i]), 1e-9) << rows;
  }
}

}  // namespace
}  // namespace palpa::array
