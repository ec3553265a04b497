#include "array/solvers/loud_phases.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "array/solvers/greedy.hpp"
#include "array/solvers/gs_pat.hpp"
#include "array/solvers/hearing.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;
using Lane = Lanes8;
using Vector = Lane::Float;
static_assert(Lane::width == starts_together && lanes_together == starts_together);

constexpr float none = 1e-30F;  // squares below this are 0

using Values = std::array<Vector, most_loud_foci>;

[[gnu::always_inline]] inline Vector all(float value) {
  return Vector{value, value, value, value, value, value, value, value};
}
[[gnu::always_inline]] inline Vector smaller(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}
double total(const Vector& lanes) {
  double sum = 0;
  for (std::size_t lane = 0; lane < lanes_together; ++lane)
    sum += static_cast<double>(lanes[lane]);
  return sum;
}

// R, two rows and two columns at a time: what a vector register holds.

struct Tile {
  Vector re[2][2], im[2][2];
};

[[gnu::always_inline]] inline void multiply_tile(const LaneColumns& columns, std::size_t row, std::size_t column,
                                                 Tile& tile) {
  const std::size_t foci = columns.foci, stride = foci * lanes_together;
  const std::size_t rows[2] = {row, std::min(row + 1, foci - 1)}, others[2] = {column, std::min(column + 1, foci - 1)};
  const float* const re = columns.re.data();
  const float* const im = columns.im.data();
  Vector sum_re[2][2], sum_im[2][2];
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b)
      sum_re[a][b] = sum_im[a][b] = all(0);
  }
  for (std::size_t at = 0; at < columns.blocks * stride; at += stride) {
    Vector x[2], y[2];
    for (int b = 0; b < 2; ++b) {
      x[b] = load_lanes<Lane>(re + at + others[b] * lanes_together);
      y[b] = load_lanes<Lane>(im + at + others[b] * lanes_together);
    }
    for (int a = 0; a < 2; ++a) {
      const Vector u = load_lanes<Lane>(re + at + rows[a] * lanes_together);
      const Vector v = load_lanes<Lane>(im + at + rows[a] * lanes_together);
      for (int b = 0; b < 2; ++b) {
        sum_re[a][b] += u * x[b] + v * y[b];
        sum_im[a][b] += v * x[b] - u * y[b];
      }
    }
  }
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      tile.re[a][b] = sum_re[a][b];
      tile.im[a][b] = sum_im[a][b];
    }
  }
}

void multiply(const LaneColumns& columns, FocusMatrix& matrix) {
  const std::size_t foci = columns.foci;
  matrix.foci = foci;
  matrix.re.resize(foci * foci);
  matrix.im.resize(foci * foci);
  for (std::size_t row = 0; row < foci; row += 2) {
    for (std::size_t column = 0; column <= row; column += 2) {
      Tile tile;
      in_lanes([&](auto) PALPA_INLINED { multiply_tile(columns, row, column, tile); });
      for (std::size_t a = 0; a < 2 && row + a < foci; ++a) {
        for (std::size_t b = 0; b < 2 && column + b < foci; ++b) {
          const std::size_t j = row + a, k = column + b;
          matrix.re[k * foci + j] = matrix.re[j * foci + k] = total(tile.re[a][b]);
          matrix.im[k * foci + j] = j == k ? 0 : total(tile.im[a][b]);
          matrix.im[j * foci + k] = -matrix.im[k * foci + j];
        }
      }
    }
  }
}

/// Factors of eight starts, by focus, and those of their loudest moments.
struct Starts {
  Values re, im, best_re, best_im;
  Vector merit;
};

struct StartGoal {
  std::size_t foci;
  const float* matrix;  ///< of R, real and imaginary part in turns, rows of `foci`
  const float* claims;
  std::uint32_t steps;
};

[[gnu::always_inline]] inline void run_starts(const StartGoal& goal, Starts& starts) {
  const std::size_t foci = goal.foci;
  Values re, im, size;
  float claimed = 0;
  for (std::size_t j = 0; j < foci; ++j)
    claimed += goal.claims[j];
  starts.merit = all(-1);
  for (std::uint32_t step = 0; step <= goal.steps; ++step) {
    Vector power = all(none), weakest = all(1e30F), level = all(0);
    const float* entry = goal.matrix;
    for (std::size_t j = 0; j < foci; ++j) {
      Vector x = all(0), y = all(0);
      for (std::size_t k = 0; k < foci; ++k, entry += 2) {
        x += entry[0] * starts.re[k] - entry[1] * starts.im[k];
        y += entry[0] * starts.im[k] + entry[1] * starts.re[k];
      }
      power += x * starts.re[j] + y * starts.im[j];
      const Vector square = x * x + y * y + none;
      const Vector inverse = inverse_root<Lane>(square);
      const Vector loud = square * inverse;
      if (goal.claims[j] > 0) weakest = smaller(weakest, loud * (1 / goal.claims[j]));
      level += loud;
      re[j] = x * inverse;  // the phases
      im[j] = y * inverse;
      size[j] = loud;
    }
    const Vector merit = weakest * inverse_root<Lane>(power);
    const auto louder = merit > starts.merit;
    starts.merit = louder ? merit : starts.merit;
    for (std::size_t j = 0; j < foci; ++j) {
      starts.best_re[j] = louder ? starts.re[j] : starts.best_re[j];
      starts.best_im[j] = louder ? starts.im[j] : starts.best_im[j];
    }
    if (step == goal.steps) return;
    level *= 1 / claimed;
    Vector sum = all(0);
    for (std::size_t j = 0; j < foci; ++j) {
      const Vector before = starts.re[j] * starts.re[j] + starts.im[j] * starts.im[j] + none;
      size[j] = before * inverse_root<Lane>(before) * smaller(goal.claims[j] * level / size[j], all(4));
      sum += size[j];
    }
    const Vector scale = static_cast<float>(foci) / sum;
    for (std::size_t j = 0; j < foci; ++j) {
      const Vector next = smaller(size[j] * scale, all(static_cast<float>(gs_pat_most_weight)));
      starts.re[j] = re[j] * next;
      starts.im[j] = im[j] * next;
    }
  }
}

/// Fills `drive` with x for these factors, and its pressure.
[[gnu::always_inline]] inline void sound_all(const LaneColumns& columns, const float* factor_re, const float* factor_im,
                                             LaneDrives& drive, Values& sum_re, Values& sum_im) {
  const std::size_t foci = columns.foci;
  const float* re = columns.re.data();
  const float* im = columns.im.data();
  float* to_re = drive.re.data();
  float* to_im = drive.im.data();
  for (std::size_t j = 0; j < foci; ++j)
    sum_re[j] = sum_im[j] = all(0);
  for (std::size_t block = 0; block < columns.blocks; ++block) {
    Vector x = all(0), y = all(0);
    for (std::size_t j = 0; j < foci; ++j) {
      const Vector u = load_lanes<Lane>(re + j * lanes_together), v = load_lanes<Lane>(im + j * lanes_together);
      x += factor_re[j] * u + factor_im[j] * v;
      y += factor_im[j] * u - factor_re[j] * v;
    }
    const Vector by = inverse_root<Lane>(x * x + y * y + none);
    x *= by;
    y *= by;
    for (std::size_t j = 0; j < foci; ++j) {
      const Vector u = load_lanes<Lane>(re + j * lanes_together), v = load_lanes<Lane>(im + j * lanes_together);
      sum_re[j] += x * u - y * v;
      sum_im[j] += x * v + y * u;
    }
    store_lanes<Lane>(x, to_re);
    store_lanes<Lane>(y, to_im);
    re += foci * lanes_together;
    im += foci * lanes_together;
    to_re += lanes_together;
    to_im += lanes_together;
  }
}

void sound(const LaneColumns& columns, std::span<const Complex> factors, LaneDrives& drive,
           std::span<Complex> pressure) {
  std::array<float, most_loud_foci> re, im;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    re[j] = static_cast<float>(factors[j].real());
    im[j] = static_cast<float>(factors[j].imag());
  }
  drive.re.resize(columns.blocks * lanes_together);
  drive.im.resize(columns.blocks * lanes_together);
  Values sum_re, sum_im;
  in_lanes([&](auto) PALPA_INLINED { sound_all(columns, re.data(), im.data(), drive, sum_re, sum_im); });
  for (std::size_t j = 0; j < factors.size(); ++j)
    pressure[j] = {total(sum_re[j]), total(sum_im[j])};
}

/// Weighted Gerchberg-Saxton with all amplitudes at 1. Replaces the factors by those of the loudest moment, and returns
/// the weakest focus then. `drive`, `next` and `pressure` are working memory.
double step_phases(const LaneColumns& columns, std::span<const double> targets, std::uint32_t steps,
                   std::span<Complex> factors, LaneDrives& drive, std::span<Complex> next,
                   std::span<Complex> pressure) {
  const std::size_t foci = factors.size();
  double wanted = 0;
  for (const double target : targets)
    wanted += target;
  std::ranges::copy(factors, next.begin());
  double best = -1;
  for (std::uint32_t step = 0;; ++step) {
    sound(columns, next, drive, pressure);
    const double weakest = weakest_of(targets, [&](std::size_t j) { return magnitude(pressure[j]); });
    if (weakest > best) {
      best = weakest;
      std::ranges::copy(next, factors.begin());
    }
    if (step == steps) return best;
    double heard = 0, sum = 0;
    for (std::size_t j = 0; j < foci; ++j)
      heard += magnitude(pressure[j]);
    const double level = heard / wanted;
    for (std::size_t j = 0; j < foci; ++j) {
      const double loud = magnitude(pressure[j]), aim = targets[j] * level;
      const double size = magnitude(next[j]) * (aim < 4 * loud ? aim / loud : 4);
      if (loud > 0) next[j] = size / loud * pressure[j];
      sum += size;
    }
    for (Complex& factor : next)
      factor *= static_cast<double>(foci) / sum;
  }
}

/// One solution.
class Loud {
 public:
  Loud(const Columns& columns, std::span<const double> gains, const LoudEfforts& efforts, LoudScratch& scratch)
      : columns_(columns), gains_(gains), efforts_(efforts), foci_(columns.foci), s_(scratch) {}

  void find() {
    take_lanes(columns_, columns_.transducers, s_.all);
    multiply(take_part(), s_.matrix);
    if (is_crowded()) effort_ = efforts_.crowded;
    const LaneColumns& part = take_part();
    const bool whole = &part == &s_.all;
    find_claims();
    find_targets();
    for (std::vector<Complex>* values : {&s_.next, &s_.best, &s_.pressure})
      values->resize(foci_);
    s_.shares.resize(foci_);
    s_.best_shares.resize(foci_);
    try_starts();
    choose(part);
    const bool differ = std::ranges::any_of(gains_, [](double gain) { return gain != 1; });
    if (differ || !whole) {
      for (std::size_t j = 0; j < foci_; ++j)
        s_.best[j] *= gains_[j];
      if (differ) step_phases(s_.all, s_.targets, effort_.phase_steps, s_.best, s_.best_drive, s_.next, s_.pressure);
      sound(s_.all, s_.best, s_.best_drive, s_.pressure);
      take_shares(s_.best, s_.targets, s_.best_shares);
    }
  }
  /// The drive is `best_drive`.
  void finish() { climb(s_.all, s_.targets, effort_.finish, s_.best_shares, s_.best_drive, s_.climb); }

 private:
  const LaneColumns& take_part() {
    const std::size_t count = effort_.transducers;
    if (count >= columns_.transducers) return s_.all;
    if (taken_ != count) take_lanes(columns_, count, s_.part);
    taken_ = count;
    return s_.part;
  }
  bool is_crowded() const {
    std::size_t unresolved = 0;
    for (std::size_t j = 0; j < foci_; ++j) {
      bool resolved = true;
      for (std::size_t k = 0; k < foci_; ++k)
        resolved = resolved && (k == j || heard_part(s_.matrix, j, k) < gs_pat_crowded);
      unresolved += resolved ? 0 : 1;
    }
    return 2 * unresolved >= foci_;
  }
  static void take_shares(std::span<const Complex> factors, std::span<const double> targets, std::span<double> shares) {
    for (std::size_t j = 0; j < factors.size(); ++j)
      shares[j] = magnitude(factors[j]) * targets[j];
  }
  void find_claims() {
    s_.alone.assign(foci_, 0);
    const double* loud = columns_.loud.data();
    double* const alone = s_.alone.data();
    for (std::size_t n = 0; n < columns_.transducers; ++n, loud += foci_) {
      for (std::size_t j = 0; j < foci_; ++j)
        alone[j] += loud[j];
    }
    const double loudest = *std::ranges::max_element(s_.alone);
    s_.claims.resize(foci_);
    for (std::size_t j = 0; j < foci_; ++j)
      s_.claims[j] = loudest > 0 ? std::min(1.0, gs_pat_most_help * s_.alone[j] / loudest) : 1.0;
  }
  void find_targets() {
    s_.targets.resize(foci_);
    for (std::size_t j = 0; j < foci_; ++j) {
      double gain = gains_[j];
      for (std::size_t k = 0; k < foci_; ++k) {
        if (k == j || gains_[k] <= gain) continue;
        const double same = (heard_part(s_.matrix, j, k) - gs_pat_same) / (1 - gs_pat_same);
        gain = std::max(gain, gains_[k] * std::clamp(same, 0.0, 1.0));
      }
      s_.targets[j] = gain * s_.claims[j];
    }
  }

  /// Fills `starts` and `merits`.
  void try_starts() {
    const std::size_t count = effort_.starts;
    s_.starts.resize(count * foci_);
    s_.merits.resize(count);
    s_.single.resize(2 * foci_ * foci_ + foci_);
    double most = 0;
    for (std::size_t j = 0; j < foci_; ++j)
      most = std::max(most, s_.matrix.alone(j));
    const double scale = most > 0 ? 1 / most : 1;  // within single precision
    float* to = s_.single.data();
    for (std::size_t j = 0; j < foci_; ++j) {
      for (std::size_t k = 0; k < foci_; ++k) {
        *to++ = static_cast<float>(scale * s_.matrix.re[k * foci_ + j]);
        *to++ = static_cast<float>(scale * s_.matrix.im[k * foci_ + j]);
      }
    }
    for (std::size_t j = 0; j < foci_; ++j)
      to[j] = static_cast<float>(s_.claims[j]);
    const StartGoal goal{foci_, s_.single.data(), to, effort_.steps};
    std::array<double, most_loud_foci> sizes;
    double sum = 0;
    for (std::size_t j = 0; j < foci_; ++j)
      sum += sizes[j] = s_.alone[j] > 0 ? s_.claims[j] / s_.alone[j] : 0;
    for (std::size_t j = 0; j < foci_; ++j)
      sizes[j] = sum > 0 ? std::min(sizes[j] * static_cast<double>(foci_) / sum, gs_pat_most_weight) : 1;
    const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(columns_.transducers));
    std::size_t next = 0;  // transducer
    for (std::size_t first = 0; first < count; first += starts_together) {
      Starts starts;
      for (std::size_t lane = 0; lane < starts_together; ++lane) {
        std::array<Complex, most_loud_foci> sounds{};
        for (std::uint32_t i = 0; i < (first + lane == 0 ? 1 : loud_sounds); ++i) {
          for (std::size_t j = 0; j < foci_; ++j)
            sounds[j] += Complex(columns_.cosine[next * foci_ + j], columns_.sine[next * foci_ + j]);
          next = (next + stride) % columns_.transducers;
        }
        for (std::size_t j = 0; j < foci_; ++j) {
          const double size = magnitude(sounds[j]);
          const Complex factor = size > 0 ? sizes[j] / size * sounds[j] : Complex(sizes[j]);
          starts.re[j][lane] = static_cast<float>(factor.real());
          starts.im[j][lane] = static_cast<float>(factor.imag());
        }
      }
      for (std::size_t j = 0; j < foci_; ++j) {
        starts.best_re[j] = starts.re[j];
        starts.best_im[j] = starts.im[j];
      }
      in_lanes([&](auto) PALPA_INLINED { run_starts(goal, starts); });
      for (std::size_t lane = 0; lane < starts_together; ++lane) {
        s_.merits[first + lane] = static_cast<double>(starts.merit[lane]);
        for (std::size_t j = 0; j < foci_; ++j)
          s_.starts[(first + lane) * foci_ + j] = {static_cast<double>(starts.best_re[j][lane]),
                                                   static_cast<double>(starts.best_im[j][lane])};
      }
    }
  }

  std::span<Complex> start(std::size_t number) { return std::span(s_.starts).subspan(number * foci_, foci_); }
  static std::size_t take_largest(std::vector<double>& merits) {
    const auto most = std::ranges::max_element(merits);
    *most = -1;
    return static_cast<std::size_t>(most - merits.begin());
  }

  /// Fills `best`, its drive of the part, and its shares.
  void choose(const LaneColumns& part) {
    s_.stepped.assign(effort_.starts, -1);
    for (std::uint32_t i = 0; i < effort_.steppers; ++i) {
      const std::size_t next = take_largest(s_.merits);
      s_.stepped[next] = step_phases(part, s_.claims, effort_.phase_steps, start(next), s_.drive, s_.next, s_.pressure);
    }
    double best = -1;
    for (std::uint32_t i = 0; i < effort_.finalists; ++i) {
      const std::span<const Complex> factors = start(take_largest(s_.stepped));
      sound(part, factors, s_.drive, s_.pressure);
      take_shares(factors, s_.claims, s_.shares);
      const double weakest =
          effort_.finalists > 1 ? climb(part, s_.claims, effort_.climb, s_.shares, s_.drive, s_.climb) : 0;
      if (weakest <= best) continue;
      best = weakest;
      std::ranges::copy(factors, s_.best.begin());
      std::swap(s_.best_drive, s_.drive);
      std::swap(s_.best_shares, s_.shares);
    }
  }

  const Columns& columns_;
  const std::span<const double> gains_;
  const LoudEfforts& efforts_;
  LoudEffort effort_ = efforts_.resolved;
  std::size_t taken_ = 0;  ///< transducers of the part
  const std::size_t foci_;
  LoudScratch& s_;
};

/// The magnitudes of the drive under `clamp`: those of the sums of the foci's q_j, which are gs_pat_fill times as large
/// as those of foci that do not hear each other, at most 1.
void clamp_sizes(const Columns& columns, std::span<const double> gains, std::span<const double> alone,
                 std::span<const Complex> factors, std::vector<double>& sizes, LaneDrives& drive) {
  const std::size_t foci = columns.foci, transducers = columns.transducers;
  std::array<double, most_loud_foci> re, im, squares{};
  for (std::size_t j = 0; j < foci; ++j) {
    re[j] = factors[j].real() * alone[j];
    im[j] = factors[j].imag() * alone[j];
  }
  sizes.resize(transducers);
  double power = 0;
  for (std::size_t n = 0; n < transducers; ++n) {
    double x = 0, y = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      const std::size_t entry = n * foci + j;
      const double b_re = columns.asked[entry] * columns.cosine[entry],
                   b_im = -columns.asked[entry] * columns.sine[entry];
      x += re[j] * b_re - im[j] * b_im;
      y += re[j] * b_im + im[j] * b_re;
      squares[j] += columns.asked[entry] * columns.asked[entry];
    }
    sizes[n] = std::sqrt(x * x + y * y);
    power += x * x + y * y;
  }
  double wanted = 0;
  for (std::size_t j = 0; j < foci; ++j)
    wanted += gains[j] * gains[j] * squares[j];
  const double by = power > 0 ? gs_pat_fill * std::sqrt(wanted / power) : 1;
  for (std::size_t n = 0; n < transducers; ++n) {
    const auto size = static_cast<float>(std::min(1.0, by * sizes[n]));
    drive.re[n] *= size;
    drive.im[n] *= size;
  }
}

}  // namespace

bool are_near(const Columns& part, FocusMatrix& scratch) {
  multiply(part, scratch);
  return some_hear(scratch, loud_near);
}

void take_part(const Columns& columns, std::size_t count, Columns& part) {
  const std::size_t foci = columns.foci;
  part.foci = foci;
  part.transducers = std::min(count, columns.transducers);
  for (std::vector<double>* values : {&part.cosine, &part.sine, &part.loud, &part.asked})
    values->resize(part.transducers * foci);
  const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(columns.transducers));
  for (std::size_t i = 0, n = 0; i < part.transducers; ++i, n = (n + stride) % columns.transducers) {
    for (std::size_t j = 0; j < foci; ++j) {
      part.cosine[i * foci + j] = columns.cosine[n * foci + j];
      part.sine[i * foci + j] = columns.sine[n * foci + j];
      part.loud[i * foci + j] = columns.loud[n * foci + j];
      part.asked[i * foci + j] = columns.asked[n * foci + j];
    }
  }
}

Layout spread_over(const Layout& layout, std::size_t count) {
  Layout part = layout;
  part.boards.clear();
  part.transducers.clear();
  const std::size_t all = layout.transducers.size();
  const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(all));
  for (std::size_t i = 0, n = 0; i < std::min(count, all); ++i, n = (n + stride) % all)
    part.transducers.push_back(layout.transducers[n]);
  return part;
}

void reserve(LoudScratch& scratch, std::size_t transducers, std::size_t foci) {
  foci = std::min(foci, most_loud_foci);
  const std::size_t starts = loudest_of_all.resolved.starts;
  for (LaneColumns* lanes : {&scratch.all, &scratch.part}) {
    lanes->re.reserve((transducers + lanes_together) * foci);
    lanes->im.reserve((transducers + lanes_together) * foci);
  }
  for (LaneDrives* drives : {&scratch.drive, &scratch.best_drive}) {
    drives->re.reserve(transducers + lanes_together);
    drives->im.reserve(transducers + lanes_together);
  }
  for (std::vector<double>* values : {&scratch.matrix.re, &scratch.matrix.im})
    values->reserve(foci * foci);
  scratch.single.reserve(2 * foci * foci + foci);
  scratch.starts.reserve(starts * foci);
  for (std::vector<double>* values : {&scratch.merits, &scratch.stepped})
    values->reserve(starts);
  for (std::vector<Complex>* values : {&scratch.next, &scratch.best, &scratch.pressure})
    values->reserve(foci);
  for (std::vector<double>* values :
       {&scratch.alone, &scratch.claims, &scratch.targets, &scratch.shares, &scratch.best_shares})
    values->reserve(foci);
  scratch.sizes.reserve(transducers);
  reserve(scratch.climb, transducers, foci);
}

void loud_phases(const Columns& columns, std::span<const double> gains, Constraint constraint,
                 const LoudEfforts& efforts, std::span<Complex> sums, LoudScratch& scratch) {
  assert(columns.foci >= 2 && columns.foci <= most_loud_foci && gains.size() == columns.foci);
  Loud loud(columns, gains, efforts, scratch);
  loud.find();
  if (constraint == Constraint::clamp)
    clamp_sizes(columns, gains, scratch.alone, scratch.best, scratch.sizes, scratch.best_drive);
  loud.finish();
  for (std::size_t n = 0; n < sums.size(); ++n) {
    const double x = static_cast<double>(scratch.best_drive.re[n]), y = static_cast<double>(scratch.best_drive.im[n]);
    sums[n] = {x, y};
  }
}

}  // namespace palpa::array
