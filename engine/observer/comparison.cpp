#include "observer/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "study/statistics/moments.hpp"

namespace palpa::observer {
namespace {

using study::Confusion;

std::vector<double> shares_of(const Confusion& table) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t j = 0; j < table.size(); ++j)
      shares.push_back(share(table, i, j).value_or(0));
  }
  return shares;
}

std::vector<double> errors_of(const std::vector<double>& shares, std::size_t shapes) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (i % (shapes + 1) != 0) errors.push_back(shares[i]);
  }
  return errors;
}

std::optional<double> correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t shapes) {
  const std::optional<study::Correlation> found = study::pearson(errors_of(a, shapes), errors_of(b, shapes));
  return found ? std::optional(found->r) : std::nullopt;
}

double rms(const std::vector<double>& a, const std::vector<double>& b) {
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square / static_cast<double>(a.size()));
}

TableFit fit_of(const std::vector<double>& predicted, const Confusion& table) {
  const std::vector<double> observed = shares_of(table);
  TableFit fit{.rms = rms(predicted, observed), .errors_r = correlation(predicted, observed, table.size())};
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
    square += rms(drawn, truth) * rms(drawn, truth);
    if (const std::optional<double> one = correlation(drawn, truth, shapes)) {
      r += *one;
      ++correlated;
    }
  }
  method.ceiling_rms = std::sqrt(square / tables);
  if (correlated > 0) method.ceiling_r = r / correlated;
}

/// The table with its shapes in this order; empty if they are others.
std::optional<Confusion> in_order(const Confusion& table, const std::vector<std::string>& shapes) {
  if (table.size() != shapes.size()) return {};
  Confusion ordered(shapes);
  std::vector<std::size_t> from;
  for (const std::string& shape : shapes) {
    const auto found = std::ranges::find(table.shapes, shape);
    if (found == table.shapes.end()) return {};
    from.push_back(static_cast<std::size_t>(found - table.shapes.begin()));
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = 0; j < shapes.size(); ++j)
      ordered.at(i, j) = table.at(from[i], from[j]);
  }
  return ordered;
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
