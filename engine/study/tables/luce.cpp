#include "study/tables/luce.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "study/statistics/special.hpp"

namespace palpa::study {
namespace {

std::vector<double> similarity_of(const std::vector<double>& cells, std::size_t m) {
  std::vector<double> similarity(m * m, 1);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      if (i != j)
        similarity[i * m + j] = std::sqrt(cells[i * m + j] * cells[j * m + i] / (cells[i * m + i] * cells[j * m + j]));
    }
  }
  return similarity;
}

/// How much larger the bias of j is than that of i, by the pair alone.
double bias_ratio(const std::vector<double>& cells, std::size_t m, std::size_t i, std::size_t j) {
  return std::sqrt(cells[i * m + j] * cells[j * m + j] / (cells[j * m + i] * cells[i * m + i]));
}

void make_sum_one(std::vector<double>& biases) {
  const double all = std::accumulate(biases.begin(), biases.end(), 0.0);
  for (double& bias : biases)
    bias /= all;
}

/// From pair to pair of cells that fit the model, where all pairs agree. Empty if some shapes are never confused with
/// the others, not even by way of a third shape: nobody can know the ratio of their biases.
std::vector<double> chained_bias(const std::vector<double>& cells, std::size_t m) {
  std::vector<double> biases(m, 0);
  std::vector<std::size_t> reached{0};
  biases[0] = 1;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const std::size_t i = reached[k];
    for (std::size_t j = 0; j < m; ++j) {
      if (biases[j] > 0 || cells[i * m + j] <= 0 || cells[j * m + i] <= 0) continue;
      biases[j] = biases[i] * bias_ratio(cells, m, i, j);
      reached.push_back(j);
    }
  }
  if (reached.size() < m) return {};
  make_sum_one(biases);
  return biases;
}

bool has_empty_row(const Confusion& table) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.row(i) == 0) return true;
  }
  return false;
}

/// Scales each group of cells to its sum in the table, in turns, until nothing changes (iterative proportional
/// fitting). The model is the same as quasi-symmetry, so its likelihood is largest where the sums of rows, of columns,
/// and of each cell with its mirror image are the table's.
std::vector<double> fitted(const Confusion& table) {
  const std::size_t m = table.size();
  std::vector<double> cells(m * m, 1);
  double change = 1;
  const auto scale = [&](const std::vector<std::size_t>& group) {
    double wanted = 0, is = 0;
    for (const std::size_t cell : group) {
      wanted += static_cast<double>(table.counts[cell]);
      is += cells[cell];
    }
    const double factor = is > 0 ? wanted / is : 0;
    for (const std::size_t cell : group)
      cells[cell] *= factor;
    if (is > 0) change = std::max(change, std::abs(factor - 1));
  };
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < m; ++i) {
    std::vector<std::size_t> row, column;
    for (std::size_t j = 0; j < m; ++j) {
      row.push_back(i * m + j);
      column.push_back(j * m + i);
      if (j > i) groups.push_back({i * m + j, j * m + i});
    }
    groups.push_back(row);
    groups.push_back(column);
    groups.push_back({i * m + i});
  }
  constexpr int most_iterations = 20'000;
  for (int i = 0; i < most_iterations && change > 1e-13; ++i) {
    change = 0;
    for (const std::vector<std::size_t>& group : groups)
      scale(group);
  }
  return cells;
}

}  // namespace

std::optional<LuceFit> luce_fit(const Confusion& table) {
  const std::size_t m = table.size();
  if (m < 3 || has_empty_row(table)) return std::nullopt;
  for (std::size_t i = 0; i < m; ++i) {
    if (table.at(i, i) == 0) return std::nullopt;
  }
  LuceFit fit;
  const std::vector<double> expected = fitted(table);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      const auto n = static_cast<double>(table.at(i, j));
      if (n == 0) continue;
      fit.deviance += 2 * n * std::log(n / expected[i * m + j]);
      fit.negative_log_likelihood -= n * std::log(expected[i * m + j] / static_cast<double>(table.row(i)));
    }
  }
  fit.deviance = std::max(0.0, fit.deviance);
  fit.degrees = static_cast<double>((m - 1) * (m - 2)) / 2;
  fit.p = chi_square_tail(fit.deviance, fit.degrees);
  fit.model = {.similarity = similarity_of(expected, m), .bias = chained_bias(expected, m)};
  if (fit.model.bias.empty()) return std::nullopt;
  return fit;
}

}  // namespace palpa::study
