#include "study/tables/confusion.hpp"

#include <algorithm>
#include <numeric>

namespace palpa::study {
namespace {

std::optional<double> quotient(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::uint64_t Confusion::row(std::size_t actual) const {
  std::uint64_t sum = 0;
  for (std::size_t j = 0; j < size(); ++j)
    sum += at(actual, j);
  return sum;
}

std::uint64_t Confusion::column(std::size_t answer) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < size(); ++i)
    sum += at(i, answer);
  return sum;
}

std::uint64_t Confusion::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::uint64_t Confusion::correct() const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < size(); ++i)
    sum += at(i, i);
  return sum;
}

void add(Confusion& table, const Confusion& more) {
  for (std::size_t i = 0; i < table.counts.size(); ++i)
    table.counts[i] += more.counts[i];
}

std::optional<Confusion> in_order(const Confusion& table, const std::vector<std::string>& shapes) {
  if (table.size() != shapes.size()) return {};
  std::vector<std::size_t> from;
  for (const std::string& shape : shapes) {
    const auto found = std::ranges::find(table.shapes, shape);
    if (found == table.shapes.end()) return {};
    from.push_back(static_cast<std::size_t>(found - table.shapes.begin()));
  }
  Confusion ordered(shapes);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = 0; j < shapes.size(); ++j)
      ordered.at(i, j) = table.at(from[i], from[j]);
  }
  return ordered;
}

double accuracy(const Confusion& table) {
  return quotient(table.correct(), table.total()).value_or(0);
}

std::optional<double> share(const Confusion& table, std::size_t actual, std::size_t answer) {
  return quotient(table.at(actual, answer), table.row(actual));
}

std::optional<double> recall(const Confusion& table, std::size_t shape) {
  return share(table, shape, shape);
}

std::optional<double> precision(const Confusion& table, std::size_t shape) {
  return quotient(table.at(shape, shape), table.column(shape));
}

}  // namespace palpa::study
