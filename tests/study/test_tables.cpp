// Measures and models of confusion matrices: the paper's tables, whose values are known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "study/tables/dprime.hpp"
#include "study/tables/information.hpp"
#include "study/tables/luce.hpp"
#include "study/tables/measures.hpp"
#include "study/tables/paper.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::study {
namespace {

TEST(Tables, ThePapersAccuracies) {
  const Confusion one = paper_single_focus(), two = paper_cross_section();
  EXPECT_EQ(accuracy(one), 0.390);
  EXPECT_EQ(accuracy(two), 0.6525);
  EXPECT_EQ(one.correct(), 156u);
  const double recalls[]{.50, .42, .26, .38}, precisions[]{.485, .331, .333, .413}, more[]{.779, .522, .714, .624};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(one.row(i), 100u);
    EXPECT_EQ(two.row(i), 100u);
    EXPECT_NEAR(recall(one, i).value(), recalls[i], 1e-15);
    EXPECT_NEAR(precision(one, i).value(), precisions[i], 5e-4);
    EXPECT_NEAR(precision(two, i).value(), more[i], 5e-4);
  }
  EXPECT_EQ(one.column(1), 127u);
}

TEST(Tables, WithoutTrialsThereAreNoShares) {
  const Confusion empty({"a", "b"});
  EXPECT_FALSE(recall(empty, 0) || precision(empty, 0) || dprime(0, 0, 2));
  EXPECT_EQ(accuracy(empty), 0);
  Confusion one({"a", "b"});
  one.at(0, 0) = 7;
  EXPECT_FALSE(recall(one, 1));
}

TEST(DPrime, OfManyAlternatives) {
  EXPECT_NEAR(correct_of_dprime(1, 2), 0.7602499389, 1e-10);
  EXPECT_NEAR(correct_of_dprime(1, 3), 0.6337020458, 1e-10);
  EXPECT_NEAR(correct_of_dprime(1, 4), 0.5520314384, 1e-10);
  constexpr std::array<std::array<double, 2>, 7> known{{{.39, 0.4892759241},
                                                        {.5, 0.8367745602},
                                                        {.6525, 1.327078511},
                                                        {.653, 1.328776837},
                                                        {.75, 1.682195195},
                                                        {.9, 2.451569426},
                                                        {.25, 0}}};
  for (const auto& [share, dprime] : known)
    EXPECT_NEAR(dprime_of_share(share, 4), dprime, 1e-9) << share;
  EXPECT_NEAR(dprime_of_share(.75, 2), 0.9538725524, 1e-10);
  EXPECT_NEAR(dprime(156, 400, 4).value(), 0.4892759241, 1e-9);
  EXPECT_NEAR(dprime(40, 40, 4).value(), dprime_of_share(79.0 / 80, 4), 1e-12) << "all correct";
  EXPECT_LT(dprime(0, 40, 4).value(), 0);
}

TEST(DPrime, OfPairs) {
  const double one[]{0.683581029, 1.42062705, 1.38343852, 0.366741866, 0.938070543, 0.259597773};
  const double two[]{2.3572018, 3.63523545, 2.05063916, 1.46050288, 1.59625859, 2.5711983};
  const Measures of_one = measure("one", paper_single_focus()), of_two = measure("two", paper_cross_section());
  ASSERT_EQ(of_one.pairs.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(of_one.pairs[i].dprime.value(), one[i], 2e-8) << i;
    EXPECT_NEAR(of_two.pairs[i].dprime.value(), two[i], 2e-8) << i;
  }
  Confusion never({"a", "b", "c"});
  never.at(0, 2) = never.at(1, 1) = 3;
  EXPECT_FALSE(dprime_of_pair(never, 0, 1)) << "a was never answered a or b";
}

TEST(Information, OfThePapersTables) {
  const Information one = information(paper_single_focus()), two = information(paper_cross_section());
  EXPECT_NEAR(one.bits, 0.1249141177, 1e-10);
  EXPECT_NEAR(two.bits, 0.6449111722, 1e-10);
  EXPECT_NEAR(one.corrected_bits, 0.1086837985, 1e-10);
  EXPECT_NEAR(two.corrected_bits, 0.628680853, 1e-9);
  EXPECT_EQ(one.most_bits, 2);
  EXPECT_NEAR(one.chi_square, 70.76176421, 1e-8);
  EXPECT_NEAR(two.chi_square, 390.4944158, 1e-7);
  EXPECT_EQ(information(Confusion({"a", "b"})).bits, 0);
}

TEST(TwoTables, ThePapersBesideEachOther) {
  const TwoTables found = compare(paper_single_focus(), paper_cross_section());
  const double chi[]{14.96550761, 16.17692245, 41.845629, 13.66415568};
  const double ratio[]{15.49412922, 17.16698364, 45.60759735, 13.86685404};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.rows[i].chi_square, chi[i], 1e-7);
    EXPECT_NEAR(found.rows[i].likelihood_ratio, ratio[i], 1e-7);
    EXPECT_EQ(found.rows[i].degrees, 3);
  }
  EXPECT_NEAR(found.all.chi_square, 86.65221474, 1e-7);
  EXPECT_NEAR(found.all.likelihood_ratio, 92.13556425, 1e-7);
  EXPECT_EQ(found.all.degrees, 12);
  EXPECT_NEAR(found.all.p / 2.188449344e-13, 1, 1e-7);
  EXPECT_NEAR(found.all.p_likelihood_ratio / 1.903254091e-14, 1, 1e-7);
  EXPECT_NEAR(found.correct.chi_square, 55.2247497, 1e-6);
  ASSERT_TRUE(found.errors);
  EXPECT_NEAR(found.errors->r, 0.589, 5e-4);
}

TEST(TwoTables, TheSameTwiceDoesNotDiffer) {
  const TwoTables found = compare(paper_single_focus(), paper_single_focus());
  EXPECT_EQ(found.rms, 0);
  EXPECT_EQ(found.all.chi_square, 0);
  EXPECT_EQ(found.all.p, 1);
  EXPECT_NEAR(found.errors->r, 1, 1e-12);
  const TwoTables empty = compare(Confusion({"a", "b"}), Confusion({"a", "b"}));
  EXPECT_EQ(empty.all.p, 1);
  EXPECT_FALSE(empty.errors);
}

TEST(TwoTables, WhatNobodyAnsweredDoesNotCount) {
  Confusion a({"a", "b", "c"}), b = a;
  // Nobody takes an a for a c; all b are recognised; only one method has a c.
  a.at(0, 0) = 9, a.at(0, 1) = 3, b.at(0, 0) = 4, b.at(0, 1) = 8;
  a.at(1, 1) = 5, b.at(1, 1) = 7;
  a.at(2, 0) = 1, a.at(2, 2) = 6;
  const TwoTables found = compare(a, b);
  const double chi = 24.0 * (9 * 8 - 3 * 4) * (9 * 8 - 3 * 4) / (12 * 12 * 13 * 11), degrees[]{1, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found.rows[i].degrees, degrees[i]) << i;
    EXPECT_NEAR(found.rows[i].chi_square, degrees[i] * chi, 1e-12) << i;
    EXPECT_NEAR(found.rows[i].p, degrees[i] > 0 ? std::erfc(std::sqrt(chi / 2)) : 1, 1e-12) << i;
  }
  EXPECT_EQ(found.all.degrees, 1);
  EXPECT_NEAR(found.all.p, found.rows[0].p, 1e-12);
}

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
  // Similarity, bias and row give back the counts that the deviance is of.
  double deviance = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    double row = 0;
    for (std::size_t j = 0; j < 4; ++j)
      row += fit->model.bias[j] * fit->model.similarity[4 * i + j];
    for (std::size_t j = 0; j < 4; ++j) {
      const double share = fit->model.bias[j] * fit->model.similarity[4 * i + j] / row;
      const auto count = static_cast<double>(table.at(i, j));
      if (count > 0) deviance += 2 * count * std::log(count / (static_cast<double>(table.row(i)) * share));
    }
  }
  EXPECT_NEAR(deviance, fit->deviance, 1e-6);
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
