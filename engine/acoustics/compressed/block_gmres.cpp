#include "acoustics/compressed/block_gmres.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

/// Least squares for a matrix that grows by columns, each with more rows than the last: the x_j that minimise
/// |H x_j - g_j|, by Householder's reflections of the columns of H.
class BandLeastSquares {
 public:
  using Number = std::complex<double>;

  /// The right-hand sides g; missing entries are zero.
  explicit BandLeastSquares(std::vector<std::vector<Number>> rights);

  /// A further column of H; it has at least as many entries as there are columns. Missing entries are zero.
  void add(std::vector<Number> column);

  std::size_t columns() const { return columns_.size(); }
  /// |H x_j - g_j| of the best x_j.
  std::vector<double> residuals() const;
  /// The best x_j: entry [column * right-hand sides + j]. Columns that, in single
  /// precision, depend on those before get zero.
  std::vector<Number> solve() const;

 private:
  /// I - 2 v v^H, where v begins at this row.
  struct Reflection {
    std::size_t row;
    std::vector<Number> v;
    void apply(std::vector<Number>& to) const;
  };

  std::vector<std::vector<Number>> rights_, columns_;
  std::vector<Reflection> reflections_;
};

/// A diagonal entry below this part of the largest one is rounding: the columns come from vectors in single precision.
constexpr double dependent_column = 1e-5;

BandLeastSquares::BandLeastSquares(std::vector<std::vector<Number>> rights) : rights_(std::move(rights)) {}

void BandLeastSquares::Reflection::apply(std::vector<Number>& to) const {
  if (v.empty() || to.size() <= row) return;
  if (to.size() < row + v.size()) to.resize(row + v.size());
  Number along = 0;
  for (std::size_t i = 0; i < v.size(); ++i)
    along += std::conj(v[i]) * to[row + i];
  along *= 2;
  for (std::size_t i = 0; i < v.size(); ++i)
    to[row + i] -= along * v[i];
}

void BandLeastSquares::add(std::vector<Number> column) {
  const std::size_t row = columns_.size();
  column.resize(std::max(column.size(), row + 1));
  for (const Reflection& reflection : reflections_)
    reflection.apply(column);
  // Takes the part from `row` on to its first entry.
  Reflection reflection{row, {column.begin() + static_cast<std::ptrdiff_t>(row), column.end()}};
  const auto length = [](const std::vector<Number>& v) {
    double sum = 0;
    for (const Number& x : v)
      sum += std::norm(x);
    return std::sqrt(sum);
  };
  const double size = length(reflection.v), first = std::abs(column[row]);
  const Number turn = first > 0 ? column[row] / first : 1.0;
  reflection.v[0] += turn * size;
  const double whole = length(reflection.v);
  if (whole > 0) {
    for (Number& x : reflection.v)
      x /= whole;
  } else {
    reflection.v.clear();
  }
  reflection.apply(column);
  for (std::vector<Number>& right : rights_) {
    right.resize(std::max(right.size(), row + reflection.v.size()));
    reflection.apply(right);
  }
  reflections_.push_back(std::move(reflection));
  columns_.push_back(std::move(column));
}

std::vector<double> BandLeastSquares::residuals() const {
  std::vector<double> left;
  for (const std::vector<Number>& right : rights_) {
    double sum = 0;
    for (std::size_t i = columns_.size(); i < right.size(); ++i)
      sum += std::norm(right[i]);
    left.push_back(std::sqrt(sum));
  }
  return left;
}

std::vector<BandLeastSquares::Number> BandLeastSquares::solve() const {
  const std::size_t size = columns_.size(), count = rights_.size();
  double most = 0;
  for (std::size_t c = 0; c < size; ++c)
    most = std::max(most, std::abs(columns_[c][c]));
  std::vector<Number> x(size * count);
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<Number> right = rights_[j];
    right.resize(std::max(right.size(), size));
    for (std::size_t c = size; c-- > 0;) {
      if (!(std::abs(columns_[c][c]) > dependent_column * most)) continue;
      const Number value = right[c] / columns_[c][c];
      x[c * count + j] = value;
      for (std::size_t i = 0; i < c; ++i)
        right[i] -= value * columns_[c][i];
    }
  }
  return x;
}

using Complex = std::complex<double>;

constexpr std::size_t rows_per_chunk = 2048;
/// A direction is rounding if less than this part of it is perpendicular to the others.
constexpr double dependent = 1e-5;
/// The estimate of the residual has to be this far below the tolerance: it loses digits.
constexpr double margin = 0.9;

float* vector_at(const SplitVectors& vectors, std::size_t v) {
  return vectors.of + 2 * vectors.stride * v;
}

/// Dot products left_i^H right_j, in doubles: entry [i * rights + j].
std::vector<Complex> dots(const SplitVectors& left, std::size_t lefts, const SplitVectors& right, std::size_t rights) {
  const std::size_t stride = right.stride, chunks = chunk_count(stride, rows_per_chunk);
  std::vector<float> conjugate(2 * stride * rights), parts(chunks * 2 * lefts * rights);
  parallel_chunks(stride, rows_per_chunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t v = 0; v < rights; ++v) {
      const float* const from = vector_at(right, v);
      float* const to = &conjugate[2 * stride * v];
      for (std::size_t i = begin; i < end; ++i) {
        to[i] = from[i];
        to[stride + i] = -from[stride + i];
      }
    }
    dot_columns({left.of + begin, end - begin, lefts, left.stride}, {conjugate.data() + begin, stride}, rights,
                &parts[chunk * 2 * lefts * rights]);
  });
  std::vector<Complex> sums(lefts * rights);
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const float* const part = &parts[2 * (chunk * sums.size() + i)];
      sums[i] += Complex(static_cast<double>(part[0]), -static_cast<double>(part[1]));
    }
  }
  return sums;
}

/// right_j += sum over i of left_i factors[i * rights + j].
void add(const SplitVectors& left, std::size_t lefts, const std::vector<Complex>& factors, double sign,
         const SplitVectors& right, std::size_t rights) {
  std::vector<float> numbers(2 * lefts * rights);
  for (std::size_t i = 0; i < lefts * rights; ++i) {
    numbers[2 * i] = static_cast<float>(sign * factors[i].real());
    numbers[2 * i + 1] = static_cast<float>(sign * factors[i].imag());
  }
  parallel_chunks(right.stride, rows_per_chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
    add_columns({left.of + begin, end - begin, lefts, left.stride}, numbers.data(), rights,
                {right.of + begin, right.stride});
  });
}

double norm(const SplitVectors& vectors, std::size_t v) {
  const SplitVectors one{vector_at(vectors, v), vectors.stride};
  return std::sqrt(std::max(dots(one, 1, one, 1)[0].real(), 0.0));
}

void scale(const SplitVectors& vectors, std::size_t v, double factor) {
  float* const of = vector_at(vectors, v);
  for (std::size_t i = 0; i < 2 * vectors.stride; ++i)
    of[i] = static_cast<float>(static_cast<double>(of[i]) * factor);
}

/// Orthonormal directions that grow.
class Directions {
 public:
  /// The system gives memory when it is used first, so that few directions take little.
  Directions(std::size_t stride, std::size_t most)
      : stride_(stride), of_(std::make_unique_for_overwrite<float[]>(2 * stride * most)) {}
  std::size_t count() const { return count_; }
  SplitVectors from(std::size_t first) { return {&of_[2 * stride_ * first], stride_}; }

  /// Adds what is new in `vectors`, whose contents are lost. Returns the parts of each along all directions, old and
  /// new: parts[v][direction].
  std::vector<std::vector<Complex>> extend(const SplitVectors& vectors, std::size_t count) {
    std::vector<std::vector<Complex>> parts(count, std::vector<Complex>(count_));
    std::vector<double> before(count);
    for (std::size_t v = 0; v < count; ++v)
      before[v] = norm(vectors, v);
    const std::size_t old = count_;
    for (int pass = 0; pass < 2 && old > 0; ++pass) {
      const std::vector<Complex> along = dots(from(0), old, vectors, count);
      add(from(0), old, along, -1, vectors, count);
      for (std::size_t v = 0; v < count; ++v) {
        for (std::size_t i = 0; i < old; ++i)
          parts[v][i] += along[i * count + v];
      }
    }
    for (std::size_t v = 0; v < count; ++v) {
      const SplitVectors own{vector_at(vectors, v), stride_};
      for (int pass = 0; pass < 2 && count_ > old; ++pass) {
        const std::vector<Complex> along = dots(from(old), count_ - old, own, 1);
        add(from(old), count_ - old, along, -1, own, 1);
        parts[v].resize(count_);
        for (std::size_t i = old; i < count_; ++i)
          parts[v][i] += along[i - old];
      }
      const double left = norm(own, 0);
      if (!(left > dependent * before[v])) continue;
      scale(own, 0, 1 / left);
      std::copy_n(own.of, 2 * stride_, from(count_).of);
      parts[v].push_back(left);
      ++count_;
    }
    return parts;
  }

 private:
  std::size_t stride_, count_ = 0;
  std::unique_ptr<float[]> of_;
};

class Solver {
 public:
  Solver(const VectorMap& matrix, const VectorMap& precondition, const SplitVectors& b, std::size_t count,
         const SplitVectors& x, const GmresSetting& setting, const std::atomic<bool>* give_up)
      : matrix_(matrix),
        precondition_(precondition),
        b_(b),
        x_(x),
        setting_(setting),
        count_(count),
        give_up_(give_up) {}

  SolveReport run() {
    SolveReport report;
    const std::size_t stride = b_.stride;
    std::vector<float> residual(2 * stride * count_);
    for (std::size_t v = 0; v < count_; ++v) {
      sizes_.push_back(norm(b_, v));
      std::fill_n(vector_at(x_, v), 2 * stride, 0.0F);
      std::copy_n(vector_at(b_, v), 2 * stride, &residual[2 * stride * v]);
    }
    report.residual = 1;
    if (std::ranges::all_of(sizes_, [](double size) { return size == 0; })) return {0, 0};
    std::vector<float> kept(2 * stride * count_);
    while (report.iterations < setting_.most_iterations) {
      const double before = report.residual;
      std::copy_n(x_.of, kept.size(), kept.begin());
      improve({residual.data(), stride}, report);
      // The residual itself, since its estimate from the directions loses digits.
      matrix_(x_, count_, {residual.data(), stride});
      report.residual = 0;
      for (std::size_t v = 0; v < count_; ++v) {
        float* const r = &residual[2 * stride * v];
        const float* const right = vector_at(b_, v);
        for (std::size_t i = 0; i < 2 * stride; ++i)
          r[i] = right[i] - r[i];
        if (sizes_[v] > 0) report.residual = std::max(report.residual, norm({r, stride}, 0) / sizes_[v]);
      }
      if (report.residual <= setting_.tolerance) break;
      if (report.residual < 0.9 * before) continue;
      if (report.residual > before) {  // rounding has spoiled the last improvement
        std::ranges::copy(kept, x_.of);
        report.residual = before;
      }
      break;
    }
    return report;
  }

 private:
  /// Adds to x the best correction within the directions that `residual` leads to.
  void improve(const SplitVectors& residual, SolveReport& report) {
    const std::size_t stride = residual.stride;
    Directions directions(stride, setting_.most_directions + 2 * count_);
    BandLeastSquares squares(directions.extend(residual, count_));
    std::vector<float> image, conditioned;
    // Counts thousandths of the decades that the residual falls.
    const auto fallen = [](double to) {
      return static_cast<std::uint64_t>(-1000 * std::log10(std::clamp(to, 1e-30, 1.0)));
    };
    Activity activity("solving for the sound on the surface", fallen(setting_.tolerance));
    while (directions.count() < setting_.most_directions && report.iterations < setting_.most_iterations) {
      stop_if(give_up_);
      const std::size_t first = squares.columns(), wide = directions.count() - first;
      if (wide == 0) break;
      conditioned.resize(2 * stride * wide);
      image.resize(2 * stride * wide);
      precondition_(directions.from(first), wide, {conditioned.data(), stride});
      matrix_({conditioned.data(), stride}, wide, {image.data(), stride});
      for (const std::vector<Complex>& column : directions.extend({image.data(), stride}, wide))
        squares.add(column);
      ++report.iterations;
      const std::vector<double> left = squares.residuals();
      double most = 0;
      for (std::size_t v = 0; v < count_; ++v) {
        if (sizes_[v] > 0) most = std::max(most, left[v] / sizes_[v]);
      }
      if (most <= margin * setting_.tolerance) break;
      activity.reach(fallen(most));
    }
    const std::vector<Complex> best = squares.solve();
    const std::size_t used = squares.columns();
    std::vector<float> sum(2 * stride * count_);
    add(directions.from(0), used, best, 1, {sum.data(), stride}, count_);
    conditioned.resize(2 * stride * count_);
    precondition_({sum.data(), stride}, count_, {conditioned.data(), stride});
    for (std::size_t v = 0; v < count_; ++v) {
      float* const to = vector_at(x_, v);
      for (std::size_t i = 0; i < 2 * stride; ++i)
        to[i] += conditioned[2 * stride * v + i];
    }
  }

  const VectorMap& matrix_;
  const VectorMap& precondition_;
  SplitVectors b_, x_;
  const GmresSetting& setting_;
  std::size_t count_;
  const std::atomic<bool>* give_up_;
  std::vector<double> sizes_;
};

}  // namespace

SolveReport block_gmres(const VectorMap& matrix, const VectorMap& precondition, const SplitVectors& b,
                        std::size_t count, const SplitVectors& x, const GmresSetting& setting,
                        const std::atomic<bool>* give_up) {
  return Solver(matrix, precondition, b, count, x, setting, give_up).run();
}

}  // namespace palpa::acoustics
