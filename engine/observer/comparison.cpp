#include "observer/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::observer {
namespace {

using study::Confusion;

std::optional<double> r_of_errors(const std::vector<double>& a, const std::vector<double>& b) {
  const std::optional<study::Correlation> found = study::correlation_of_errors(a, b);
  return found ? std::optional(found->r) : std::nullopt;
}

TableFit fit_of(const std::vector<double>& predicted, const Confusion& table) {
  const std::vector<double> observed = shares_of(table);
  TableFit fit{.rms = study::rms_difference(predicted, observed), .errors_r = r_of_errors(predicted, observed)};
  for (std::size_t i = 0; i < predicted.size(); ++i)
    fit.log_likelihood += static_cast<double>(table.counts[i]) * std::log(std::max(predicted[i], 1e-3));
  fit.log_likelihood /= static_cast<double>(std::max<std::uint64_t>(1, table.total()));
  return fit;
}

/// Tables of the same size drawn from the observed shares, beside these.
void add_ceiling(ObservedMethod& method) {
  const std::size_t shapes = method.table.size();
  const std::vector<double> truth = shares_of(method.table);
  constexpr int tables = 500;
  Random random(0x6365696c);
  double square = 0, r = 0;
  int correlated = 0;
  for (int i = 0; i < tables; ++i) {
    std::vector<double> drawn;
    for (std::size_t row = 0; row < shapes; ++row) {
      auto left = static_cast<std::uint32_t>(method.table.row(row));
      const double trials = left;
      double rest = 1;
      for (std::size_t column = 0; column < shapes; ++column) {
        const double p = truth[row * shapes + column];
        const std::uint32_t count =
            column + 1 == shapes ? left : random.binomial(left, rest > 0 ? std::min(1.0, p / rest) : 0);
        drawn.push_back(trials > 0 ? count / trials : 0);
        left -= count;
        rest -= p;
      }
    }
    const double off = study::rms_difference(drawn, truth);
    square += off * off;
    if (const std::optional<double> one = r_of_errors(drawn, truth)) {
      r += *one;
      ++correlated;
    }
  }
  method.ceiling_rms = std::sqrt(square / tables);
  if (correlated > 0) method.ceiling_r = r / correlated;
}

}  // namespace

Comparison compare(const Prediction& prediction, const std::vector<ObservedTable>& observed) {
  Comparison out;
  for (const ObservedTable& one : observed) {
    const auto method = std::ranges::find(prediction.methods, one.method);
    std::optional<Confusion> table = in_order(one.table, prediction.shapes);
    if (method == prediction.methods.end() || !table || table->total() == 0) {
      out.left_out.push_back(fmt::format("{} ({}) is not beside the prediction: the plan has {}", one.source,
                                         one.method, table ? "no such method" : "other shapes"));
      continue;
    }
    ObservedMethod entry{.method = static_cast<std::size_t>(method - prediction.methods.begin()),
                         .source = one.source,
                         .table = *std::move(table),
                         .variants = {},
                         .nulls = {},
                         .chance = {},
                         .itself = {},
                         .ceiling_rms = 0,
                         .ceiling_r = {}};
    const auto fits = [&](const std::vector<PredictedVariant>& variants, std::vector<TableFit>& into) {
      for (const PredictedVariant& variant : variants)
        into.push_back(variant.methods.empty() ? TableFit()
                                               : fit_of(variant.methods[entry.method].shares, entry.table));
    };
    fits(prediction.variants, entry.variants);
    fits(prediction.nulls, entry.nulls);
    const auto shapes = static_cast<double>(prediction.shapes.size());
    entry.chance = fit_of(std::vector<double>(entry.table.counts.size(), 1 / shapes), entry.table);
    entry.itself = fit_of(shares_of(entry.table), entry.table);
    add_ceiling(entry);
    out.methods.push_back(std::move(entry));
  }
  return out;
}

}  // namespace palpa::observer
