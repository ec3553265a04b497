// Prints how loud the weakest focus of a set can be if all transducers are in full: the numbers of
// tests/array/loud_optima.txt. It is not a test; run it by hand, for minutes. It shares the forward model with the
// solvers, but none of their methods: random starts, weighted Gerchberg-Saxton over all transducers, and from the best
// of these ends L-BFGS in all phases, for a soft minimum that becomes harder and harder.
//
// Arguments: layout, fewest foci, most foci, number of sets, and optionally starts (50) and finalists (6).
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "array/field/free_field.hpp"
#include "array/loud_sets.hpp"
#include "base/system/parallel.hpp"

namespace palpa::array {
namespace {

using Reals = Eigen::ArrayXf;
using Complexes = Eigen::ArrayXcf;
constexpr float tiny = 1e-20F;

/// The sound of each transducer (column) at each focus (row).
Eigen::MatrixXcf sound_of(const Layout& layout, const std::vector<SlotFocus>& foci) {
  FreeField field;
  field.set(layout, {}, Directivity::t4010a1);
  std::vector<FocusSource> sources;
  for (const SlotFocus& focus : foci)
    sources.push_back({focus.position, 1, 1});
  Columns columns;
  field.fill(sources, Weighting::uniform, columns);
  Eigen::MatrixXcf sound(columns.foci, columns.transducers);
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    for (std::size_t j = 0; j < columns.foci; ++j) {
      sound(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(n)) =
          std::complex<float>(columns.transfer(n * columns.foci + j) * layout.source_level_pa_m);
    }
  }
  return sound;
}

double dot(const Reals& a, const Reals& b) {
  return a.matrix().cast<double>().dot(b.matrix().cast<double>());
}

class Search {
 public:
  explicit Search(const Eigen::MatrixXcf& sound) : sound_(sound) {}

  /// Weighted Gerchberg-Saxton from random phases. Returns the weakest focus; the phases are then in `phases`.
  float climb(SetRandom& random, int steps, Reals& phases) {
    Complexes wanted(sound_.rows());
    for (std::complex<float>& one : wanted)
      one = std::polar(1.0F, static_cast<float>(random.between(-3.14159265, 3.14159265)));
    Reals weight = Reals::Ones(sound_.rows());
    float best = -1;
    for (int step = 0; step <= steps; ++step) {
      sum_back(wanted);
      drives_ = back_.conjugate() / (back_.abs() + tiny);
      listen();
      if (const float weakest = size_.minCoeff(); weakest > best) {
        best = weakest;
        phases = drives_.arg();
      }
      weight *= (size_.mean() / (size_ + tiny)).min(4.0F);
      wanted = weight / (size_ + tiny) * heard_.conjugate();
    }
    return best;
  }

  /// L-BFGS in all phases. Returns the weakest focus.
  float polish(Reals& phases, int steps) {
    float best = 0;
    for (const float sharp : {20.0F, 60.0F, 200.0F, 600.0F, 2000.0F}) {
      look(phases);
      scale_ = size_.mean();
      sharp_ = sharp;
      minimise(phases, steps);
      look(phases);
      best = std::max(best, size_.minCoeff());
    }
    return best;
  }

 private:
  void sum_back(const Complexes& of_foci) { back_ = (sound_.transpose() * of_foci.matrix()).array(); }
  void listen() {
    heard_ = (sound_ * drives_.matrix()).array();
    size_ = heard_.abs();
  }
  void look(const Reals& phases) {
    drives_.resize(phases.size());
    drives_.real() = phases.cos();
    drives_.imag() = phases.sin();
    listen();
  }
  /// The soft minimum of the foci, negative, and its slope.
  double value(const Reals& phases, Reals& slope) {
    look(phases);
    const float least = size_.minCoeff();
    const Reals part = (-sharp_ / scale_ * (size_ - least)).exp();
    const float total = part.sum();
    sum_back(part / (total * scale_ * (size_ + tiny)) * heard_.conjugate());
    slope = (back_ * drives_).imag();
    return std::log(double{total}) / sharp_ - double{least} / scale_;
  }

  void minimise(Reals& at, int steps) {
    struct Pair {
      Reals moved, turned;
      double by;
    };
    std::deque<Pair> pairs;
    Reals slope, next_slope;
    double now = value(at, slope);
    for (int step = 0; step < steps; ++step) {
      const Reals stiff = back_.abs();
      Reals way = slope;
      std::vector<double> parts(pairs.size());
      for (std::size_t i = pairs.size(); i-- > 0;) {
        parts[i] = pairs[i].by * dot(pairs[i].moved, way);
        way -= static_cast<float>(parts[i]) * pairs[i].turned;
      }
      way /= stiff + 0.2F * stiff.mean();
      for (std::size_t i = 0; i < pairs.size(); ++i)
        way += static_cast<float>(parts[i] - pairs[i].by * dot(pairs[i].turned, way)) * pairs[i].moved;
      const double falls = dot(way, slope);
      double size = 1, then = 0;
      Reals next;
      bool better = false;
      for (int i = 0; i < 10 && !better && falls > 0; ++i, size *= 0.4) {
        next = at - static_cast<float>(size) * way;
        then = value(next, next_slope);
        better = then < now - 1e-4 * size * falls;
      }
      if (!better) {
        if (pairs.empty()) return;
        pairs.clear();
        value(at, slope);
        continue;
      }
      Pair pair{next - at, next_slope - slope, 0};
      const double curved = dot(pair.moved, pair.turned);
      if (curved > 1e-12) {
        pair.by = 1 / curved;
        pairs.push_back(std::move(pair));
        if (pairs.size() > 8) pairs.pop_front();
      }
      const bool still = now - then < 1e-6;
      at.swap(next);
      slope.swap(next_slope);
      now = then;
      if (still) return;
    }
  }

  const Eigen::MatrixXcf& sound_;
  Complexes drives_, back_, heard_;  ///< of each transducer; all foci's sound, sent back to it; at each focus
  Reals size_;                       ///< of the sound at each focus
  float sharp_ = 1, scale_ = 1;
};

/// The best of all starts.
double optimum_of(const Layout& layout, std::uint32_t number, std::size_t fewest, std::size_t most, int starts,
                  int finalists) {
  const Eigen::MatrixXcf sound = sound_of(layout, loud_set(number, fewest, most, middle_of(layout)));
  Search search(sound);
  SetRandom random(number + 1);
  std::vector<std::pair<float, Reals>> ends(static_cast<std::size_t>(starts));
  for (auto& [weakest, phases] : ends)
    weakest = search.climb(random, 25, phases);
  std::ranges::sort(ends, [](const auto& a, const auto& b) { return a.first > b.first; });
  float best = 0;
  for (int i = 0; i < std::min(starts, finalists); ++i)
    best = std::max(best, search.polish(ends[static_cast<std::size_t>(i)].second, 60));
  return best;
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 4) {
    std::fprintf(stderr, "give: layout, fewest foci, most foci, sets, and optionally starts and finalists\n");
    return 2;
  }
  const Layout layout = load_layout(words[0]);
  const std::size_t fewest = std::stoul(words[1]), most = std::stoul(words[2]), sets = std::stoul(words[3]);
  const int starts = words.size() > 4 ? std::stoi(words[4]) : 50,
            finalists = words.size() > 5 ? std::stoi(words[5]) : 6;
  std::vector<double> optima(sets);
  parallel_chunks(sets, 1, [&](std::size_t set, std::size_t, std::size_t) {
    optima[set] = optimum_of(layout, static_cast<std::uint32_t>(set), fewest, most, starts, finalists);
  });
  for (std::size_t set = 0; set < sets; ++set)
    std::printf("%.0f%s", optima[set], set % 20 == 19 || set + 1 == sets ? "\n" : " ");
  return 0;
}

}  // namespace
}  // namespace palpa::array

int main(int count, char** words) {
  return palpa::array::run({words + 1, words + count});
}
