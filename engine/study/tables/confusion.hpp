// A confusion matrix: how often each shape was answered for each actual shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpa::study {

struct Confusion {
  std::vector<std::string> shapes;    ///< names, in the order of rows and columns
  std::vector<std::uint64_t> counts;  ///< by rows; rows are actual shapes, columns are answers

  Confusion() = default;
  /// All counts are 0.
  explicit Confusion(std::vector<std::string> names)
      : shapes(std::move(names)), counts(shapes.size() * shapes.size()) {}

  std::size_t size() const { return shapes.size(); }
  std::uint64_t at(std::size_t actual, std::size_t answer) const { return counts[actual * size() + answer]; }
  std::uint64_t& at(std::size_t actual, std::size_t answer) { return counts[actual * size() + answer]; }
  std::uint64_t row(std::size_t actual) const;     ///< trials of a shape
  std::uint64_t column(std::size_t answer) const;  ///< times that it was the answer
  std::uint64_t total() const;
  std::uint64_t correct() const;
  bool operator==(const Confusion&) const = default;
};

/// The table of other trials of the same shapes is added.
void add(Confusion& table, const Confusion& more);
/// The table with its shapes in this order; empty if they are others.
std::optional<Confusion> in_order(const Confusion& table, const std::vector<std::string>& shapes);

/// Correct answers over trials, 0 without trials. The quotient of two whole numbers: equal shares are equal doubles.
double accuracy(const Confusion& table);
/// The share of answers `answer` among the trials of a shape; empty without trials of it.
std::optional<double> share(const Confusion& table, std::size_t actual, std::size_t answer);
/// The share of a shape's trials that were answered correctly; empty without trials of it.
std::optional<double> recall(const Confusion& table, std::size_t shape);
/// The share of a shape's answers that were correct; empty if it was never answered.
std::optional<double> precision(const Confusion& table, std::size_t shape);

}  // namespace palpa::study
