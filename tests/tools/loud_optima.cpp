// Prints how loud the weakest focus of a set can be if all transducers are in full: the numbers of
// tests/array/loud_optima.txt. It is not a test; run it by hand, for minutes. It shares the forward model with the
// solvers, but none of their methods: random starts, weighted Gerchberg-Saxton over all transducers, and from the best
// of these ends L-BFGS in all phases, for a soft minimum that becomes harder and harder.
//
// Arguments: layout, fewest foci, most foci, number of sets, and optionally starts (50) and finalists (6).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "array/free_field.hpp"
#include "array/loud_sets.hpp"

namespace palpa::array {
namespace {

/// The sound of all transducers at all foci, focus by focus.
struct Sound {
  std::size_t foci = 0, transducers = 0;
  std::vector<float> re, im;
};

Sound sound_of(const Layout& layout, const std::vector<SlotFocus>& foci) {
  FreeField field;
  field.set(layout, {}, Directivity::t4010a1);
  std::vector<FocusSource> sources;
  for (const SlotFocus& focus : foci)
    sources.push_back({focus.position, 1, 1});
  Columns columns;
  field.fill(sources, Weighting::uniform, columns);
  Sound sound{foci.size(), columns.transducers, {}, {}};
  sound.re.resize(columns.loud.size());
  sound.im.resize(columns.loud.size());
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    for (std::size_t j = 0; j < columns.foci; ++j) {
      const auto g = columns.transfer(n * columns.foci + j) * layout.source_level_pa_m;
      sound.re[j * columns.transducers + n] = static_cast<float>(g.real());
      sound.im[j * columns.transducers + n] = static_cast<float>(g.imag());
    }
  }
  return sound;
}

class Search {
 public:
  explicit Search(const Sound& sound)
      : sound_(sound),
        x_(sound.transducers),
        y_(sound.transducers),
        h_re_(sound.transducers),
        h_im_(sound.transducers),
        p_re_(sound.foci),
        p_im_(sound.foci),
        size_(sound.foci),
        part_(sound.foci) {}

  /// Weighted Gerchberg-Saxton from random phases. Returns the weakest focus; the phases are then in `phases`.
  float climb(SetRandom& random, int steps, std::vector<float>& phases) {
    const std::size_t foci = sound_.foci;
    std::vector<float> c_re(foci), c_im(foci), weight(foci, 1);
    for (std::size_t j = 0; j < foci; ++j) {
      const double angle = random.between(-3.14159265, 3.14159265);
      c_re[j] = static_cast<float>(std::cos(angle));
      c_im[j] = static_cast<float>(std::sin(angle));
    }
    float best = -1;
    for (int step = 0; step <= steps; ++step) {
      sum_back(c_re, c_im);
      for (std::size_t n = 0; n < sound_.transducers; ++n) {
        const float size = std::sqrt(h_re_[n] * h_re_[n] + h_im_[n] * h_im_[n]) + 1e-20F;
        x_[n] = h_re_[n] / size;
        y_[n] = -h_im_[n] / size;
      }
      listen();
      if (const float weakest = *std::ranges::min_element(size_); weakest > best) {
        best = weakest;
        phases.resize(x_.size());
        for (std::size_t n = 0; n < x_.size(); ++n)
          phases[n] = std::atan2(y_[n], x_[n]);
      }
      const float mean = std::accumulate(size_.begin(), size_.end(), 0.0F) / static_cast<float>(foci);
      for (std::size_t j = 0; j < foci; ++j) {
        weight[j] *= std::min(4.0F, mean / (size_[j] + 1e-20F));
        c_re[j] = weight[j] * p_re_[j] / (size_[j] + 1e-20F);
        c_im[j] = -weight[j] * p_im_[j] / (size_[j] + 1e-20F);
      }
    }
    return best;
  }

  /// L-BFGS in all phases. Returns the weakest focus.
  float polish(std::vector<float>& phases, int steps) {
    float best = 0;
    for (const float sharp : {20.0F, 60.0F, 200.0F, 600.0F, 2000.0F}) {
      look(phases);
      scale_ = std::accumulate(size_.begin(), size_.end(), 0.0F) / static_cast<float>(sound_.foci);
      sharp_ = sharp;
      minimise(phases, steps);
      look(phases);
      best = std::max(best, *std::ranges::min_element(size_));
    }
    return best;
  }

 private:
  /// h = sum over the foci of (re + i im) G.
  void sum_back(const std::vector<float>& re, const std::vector<float>& im) {
    std::ranges::fill(h_re_, 0);
    std::ranges::fill(h_im_, 0);
    for (std::size_t j = 0; j < sound_.foci; ++j) {
      const float a = re[j], b = im[j];
      const float *const g = &sound_.re[j * x_.size()], *const i = &sound_.im[j * x_.size()];
      for (std::size_t n = 0; n < x_.size(); ++n) {
        h_re_[n] += a * g[n] - b * i[n];
        h_im_[n] += a * i[n] + b * g[n];
      }
    }
  }
  void listen() {
    for (std::size_t j = 0; j < sound_.foci; ++j) {
      const float *const g = &sound_.re[j * x_.size()], *const i = &sound_.im[j * x_.size()];
      float re = 0, im = 0;
      for (std::size_t n = 0; n < x_.size(); ++n) {
        re += g[n] * x_[n] - i[n] * y_[n];
        im += g[n] * y_[n] + i[n] * x_[n];
      }
      p_re_[j] = re;
      p_im_[j] = im;
      size_[j] = std::sqrt(re * re + im * im);
    }
  }
  void look(const std::vector<float>& phases) {
    for (std::size_t n = 0; n < x_.size(); ++n) {
      x_[n] = std::cos(phases[n]);
      y_[n] = std::sin(phases[n]);
    }
    listen();
  }
  /// The soft minimum of the foci, negative, and its slope.
  double value(const std::vector<float>& phases, std::vector<float>* slope) {
    look(phases);
    const float least = *std::ranges::min_element(size_);
    float total = 0;
    for (std::size_t j = 0; j < size_.size(); ++j)
      total += part_[j] = std::exp(-sharp_ * (size_[j] - least) / scale_);
    if (slope) {
      std::vector<float> re(size_.size()), im(size_.size());
      for (std::size_t j = 0; j < size_.size(); ++j) {
        const float by = part_[j] / total / scale_ / (size_[j] + 1e-20F);
        re[j] = by * p_re_[j];
        im[j] = -by * p_im_[j];
      }
      sum_back(re, im);
      for (std::size_t n = 0; n < x_.size(); ++n)
        (*slope)[n] = h_re_[n] * y_[n] + h_im_[n] * x_[n];
    }
    return std::log(double{total}) / sharp_ - double{least} / scale_;
  }

  static double dot(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n)
      sum += double{a[n]} * b[n];
    return sum;
  }
  void minimise(std::vector<float>& at, int steps) {
    struct Pair {
      std::vector<float> moved, turned;
      double by;
    };
    std::deque<Pair> pairs;
    std::vector<float> slope(at.size()), next_slope(at.size()), next(at.size()), way(at.size()), stiff(at.size());
    double now = value(at, &slope);
    for (int step = 0; step < steps; ++step) {
      double mean = 0;
      for (std::size_t n = 0; n < at.size(); ++n) {
        stiff[n] = std::sqrt(h_re_[n] * h_re_[n] + h_im_[n] * h_im_[n]);
        mean += stiff[n] / static_cast<double>(at.size());
      }
      way = slope;
      std::vector<double> parts(pairs.size());
      for (std::size_t i = pairs.size(); i-- > 0;) {
        parts[i] = pairs[i].by * dot(pairs[i].moved, way);
        for (std::size_t n = 0; n < at.size(); ++n)
          way[n] -= static_cast<float>(parts[i]) * pairs[i].turned[n];
      }
      for (std::size_t n = 0; n < at.size(); ++n)
        way[n] /= stiff[n] + 0.2F * static_cast<float>(mean);
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double back = pairs[i].by * dot(pairs[i].turned, way);
        for (std::size_t n = 0; n < at.size(); ++n)
          way[n] += static_cast<float>(parts[i] - back) * pairs[i].moved[n];
      }
      const double falls = dot(way, slope);
      if (!(falls > 0)) {
        if (pairs.empty()) return;
        pairs.clear();
        continue;
      }
      double size = 1, then = 0;
      bool better = false;
      for (int i = 0; i < 10 && !better; ++i, size *= 0.4) {
        for (std::size_t n = 0; n < at.size(); ++n)
          next[n] = at[n] - static_cast<float>(size) * way[n];
        then = value(next, &next_slope);
        better = then < now - 1e-4 * size * falls;
      }
      if (!better) {
        value(at, &slope);
        if (pairs.empty()) return;
        pairs.clear();
        continue;
      }
      Pair pair{next, next_slope, 0};
      for (std::size_t n = 0; n < at.size(); ++n) {
        pair.moved[n] -= at[n];
        pair.turned[n] -= slope[n];
      }
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

  const Sound& sound_;
  std::vector<float> x_, y_, h_re_, h_im_, p_re_, p_im_, size_, part_;
  float sharp_ = 1, scale_ = 1;
};

/// The best of all starts.
double optimum_of(const Layout& layout, std::uint32_t number, std::size_t fewest, std::size_t most, int starts,
                  int finalists) {
  const Sound sound = sound_of(layout, loud_set(number, fewest, most, middle_of(layout)));
  Search search(sound);
  SetRandom random(number + 1);
  std::vector<std::pair<float, std::vector<float>>> ends(static_cast<std::size_t>(starts));
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
  const std::size_t fewest = std::stoul(words[1]), most = std::stoul(words[2]);
  const auto sets = static_cast<std::uint32_t>(std::stoul(words[3]));
  const int starts = words.size() > 4 ? std::stoi(words[4]) : 50,
            finalists = words.size() > 5 ? std::stoi(words[5]) : 6;
  std::vector<double> optima(sets);
  std::atomic<std::uint32_t> next = 0;
  {
    std::vector<std::jthread> threads;
    for (unsigned core = 0; core < std::max(1U, std::thread::hardware_concurrency()); ++core) {
      threads.emplace_back([&] {
        for (std::uint32_t set = next++; set < sets; set = next++)
          optima[set] = optimum_of(layout, set, fewest, most, starts, finalists);
      });
    }
  }
  for (std::uint32_t set = 0; set < sets; ++set)
    std::printf("%.0f%s", optima[set], set % 20 == 19 || set + 1 == sets ? "\n" : " ");
  return 0;
}

}  // namespace
}  // namespace palpa::array

int main(int count, char** words) {
  return palpa::array::run({words + 1, words + count});
}
