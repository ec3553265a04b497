// Luce's similarity choice model of the paper's tables.
#include <gtest/gtest.h>

#include <cstddef>

#include "study/tables/luce.hpp"
#include "study/tables/paper.hpp"

namespace palpa::study {
namespace {

/// The pairs above the diagonal, by rows, of four shapes.
constexpr std::size_t pairs[]{1, 2, 3, 6, 7, 11};

struct Known {
  double fitted[6], fitted_bias[4], deviance, negative_log_likelihood;
};
// Pairs: cube and semi-sphere, cube and pyramid, cube and prism, semi-sphere and pyramid, semi-sphere and prism,
// pyramid and prism.
constexpr Known single{{0.576014, 0.299555, 0.318641, 0.771387, 0.452596, 0.809518},
                       {.29716873, .29759814, .17688277, .22835035},
                       4.160288411,
                       515.61573231};
constexpr Known cross{{0.141921, 0.028833, 0.175119, 0.325766, 0.286200, 0.124355},
                      {.25162899, .26404473, .23158778, .25273850},
                      25.30202174,
                      387.00096991};

void expect_known(const Confusion& table, const Known& known) {
  const auto fit = luce_fit(table);
  ASSERT_TRUE(fit);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(fit->model.similarity[pairs[i]], known.fitted[i], 1e-6) << i;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(fit->model.bias[i], known.fitted_bias[i], 2e-7) << i;
    EXPECT_EQ(fit->model.similarity[5 * i], 1);
  }
  EXPECT_NEAR(fit->deviance, known.deviance, 1e-7);
  EXPECT_NEAR(fit->negative_log_likelihood, known.negative_log_likelihood, 1e-7);
  EXPECT_EQ(fit->degrees, 3);
}

TEST(Luce, OfThePapersTables) {
  expect_known(paper_single_focus(), single);
  expect_known(paper_cross_section(), cross);
  EXPECT_NEAR(luce_fit(paper_single_focus())->p, 0.2447, 1e-4);
  EXPECT_NEAR(luce_fit(paper_cross_section())->p, 1.3e-5, 1e-6);
}

TEST(Luce, CellsOfZero) {
  Confusion table = paper_cross_section();
  table.at(0, 2) = table.at(2, 0) = 0;
  const auto fit = luce_fit(table);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->model.similarity[2], 0) << "the two were never confused";
  // The expected counts are those of the model: similarity, bias and row give them back.
  for (std::size_t i = 0; i < 4; ++i) {
    double row = 0;
    for (std::size_t j = 0; j < 4; ++j)
      row += fit->model.bias[j] * fit->model.similarity[4 * i + j];
    for (std::size_t j = 0; j < 4; ++j) {
      const double share = fit->model.bias[j] * fit->model.similarity[4 * i + j] / row;
      EXPECT_NEAR(static_cast<double>(table.row(i)) * share, fit->expected[4 * i + j], 1e-6);
    }
  }
  for (const std::size_t cell : {1u, 3u, 4u, 6u, 9u, 11u, 12u, 14u})
    table.counts[cell] = 0;
  EXPECT_FALSE(luce_fit(table)) << "cube and pyramid, semi-sphere and prism: groups that are never confused";
}

TEST(Luce, NeedsTrialsOfAllShapes) {
  Confusion table = paper_cross_section();
  for (std::size_t j = 0; j < 4; ++j)
    table.at(1, j) = 0;
  EXPECT_FALSE(luce_fit(table));
  Confusion never = paper_cross_section();
  never.at(1, 1) = 0;
  EXPECT_FALSE(luce_fit(never)) << "a shape that was never recognised";
  EXPECT_FALSE(luce_fit(Confusion({"a", "b"})));
}

}  // namespace
}  // namespace palpa::study
