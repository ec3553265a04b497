#include "observer/decision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/lanes.hpp"
#include "base/normal.hpp"
#include "base/random.hpp"
#include "base/system/parallel.hpp"

namespace palpa::observer {
namespace {

/// The products of the templates less their mean. What all templates share has no effect on decisions.
std::vector<double> centred(const Templates& templates) {
  const std::size_t n = templates.size();
  std::vector<double> products = templates.products, means(n);
  double all = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      means[i] += products[i * n + j] / static_cast<double>(n);
    all += means[i] / static_cast<double>(n);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      products[i * n + j] += all - means[i] - means[j];
  }
  return products;
}

/// A value in each of several draws.
using Float = Lanes8::Float;
constexpr std::size_t lanes = Lanes8::width;

/// The i-th of such values that lie one after the other.
[[gnu::always_inline]] inline Float of_draws(const float* values, std::size_t i) {
  return load_lanes<Lanes8>(values + lanes * i);
}

/// A matrix L with L L^T = the centred products: Cholesky's decomposition in the order of the templates, so that the
/// same draws mean much the same for every method, and a part of their errors cancels. A template that lies among
/// earlier ones to 1e-10, the rounding of the sums, adds no direction.
struct Root {
  std::vector<std::size_t> own;            ///< of each column: the template that it begins with, above which it is zero
  std::vector<std::vector<float>> values;  ///< by template: those of the columns that have begun

  explicit Root(const Templates& templates) : values(templates.size()) {
    const std::size_t n = templates.size();
    std::vector<double> rest = centred(templates);
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i)
      largest = std::max(largest, rest[i * n + i]);
    for (std::size_t first = 0; first < n; ++first) {
      const double left = rest[first * n + first];
      if (!(left > 1e-10 * largest)) continue;
      std::vector<double> column(n);
      own.push_back(first);
      for (std::size_t i = first; i < n; ++i) {
        column[i] = rest[i * n + first] / std::sqrt(left);
        values[i].push_back(static_cast<float>(column[i]));
      }
      for (std::size_t i = first; i < n; ++i) {
        for (std::size_t j = first; j < n; ++j)
          rest[i * n + j] -= column[i] * column[j];
      }
    }
  }

  /// `deviates`: one per column, of several draws. `products`: one per template.
  void multiply(const float* deviates, float* products) const {
    in_lanes([&](auto) PALPA_INLINED {
      for (std::size_t t = 0; t < values.size(); ++t) {
        const float* const row = values[t].data();
        Float sum{};
        for (std::size_t c = 0; c < values[t].size(); ++c)
          sum += of_draws(deviates, c) * row[c];
        store_lanes<Lanes8>(sum, products + lanes * t);
      }
    });
  }
};

/// e^x for x <= 0, within 1e-6 of it; exactly the same on every processor.
[[gnu::always_inline]] inline Float exponential(const Float& x) {
  const Float turns = (x > -87.0F ? x : Float{} - 87.0F) * 1.44269504F;
  const Float whole = (turns + 12582912.0F) - 12582912.0F;
  const Float y = (turns - whole) * 0.693147181F;
  const Float e =
      1.0F + y * (1.0F + y * (0.5F + y * (1.0F / 6 + y * (1.0F / 24 + y * (1.0F / 120 + y * (1.0F / 720))))));
  const Lanes8::Bits bits = (__builtin_convertvector(whole, Lanes8::Bits) + 127) << 23;
  Float power;
  std::memcpy(&power, &bits, sizeof(power));
  return e * power;
}

/// The likelihoods of a touch without the noise of its draws.
struct Candidates {
  std::vector<std::size_t> templates;  ///< those that can be meant, in order of their shapes
  std::vector<float> base;             ///< of each of them, logarithms
  std::vector<std::size_t> ends;       ///< per shape, in `templates`
};

Candidates candidates_of(const Templates& templates, std::size_t truth, double sigma) {
  const std::size_t nodes = templates.nodes(), per_shape = templates.placements * nodes;
  const std::size_t place = truth % per_shape / nodes;
  Candidates out;
  for (std::size_t t = 0; t < templates.size(); ++t) {
    const bool own = t % per_shape / nodes == place;
    if (own == (templates.placement == Placement::known)) {
      const double weight = std::log(templates.node_weights[t % nodes]);
      out.templates.push_back(t);
      out.base.push_back(static_cast<float>(weight - templates.square(truth, t) / (2 * sigma * sigma)));
    }
    if (t % per_shape == per_shape - 1) out.ends.push_back(out.templates.size());
  }
  return out;
}

/// The likelihood of each shape in several draws, times a factor of each draw. `noise`: of every template in these
/// draws. `scores`: one per candidate.
[[gnu::always_inline]] inline void likelihoods(const Candidates& candidates, const float* noise, float inverse_sigma,
                                               float* scores, float* sums) {
  // Pointers: indices of vectors are checked, which takes as long as the sums.
  const std::size_t* const templates = candidates.templates.data();
  const float* const base = candidates.base.data();
  Float largest = Float{} - 2e30F;
  for (std::size_t i = 0; i < candidates.templates.size(); ++i) {
    const Float score = base[i] + of_draws(noise, templates[i]) * inverse_sigma;
    store_lanes<Lanes8>(score, scores + lanes * i);
    largest = score > largest ? score : largest;
  }
  std::size_t i = 0;
  for (const std::size_t end : candidates.ends) {
    Float sum{};
    for (; i < end; ++i)
      sum += exponential(of_draws(scores, i) - largest);
    store_lanes<Lanes8>(sum, sums);
    sums += lanes;
  }
}

/// The shape with the largest of these likelihoods in each draw; -1 if there are several.
[[gnu::always_inline]] inline void most_likely(std::size_t shapes, const float* likelihoods, std::int32_t* best) {
  Float most = of_draws(likelihoods, 0);
  Lanes8::Bits at{};
  for (std::size_t shape = 1; shape < shapes; ++shape) {
    const Float own = of_draws(likelihoods, shape);
    at = own > most ? Lanes8::Bits{} + static_cast<std::int32_t>(shape) : own == most ? Lanes8::Bits{} - 1 : at;
    most = own > most ? own : most;
  }
  std::memcpy(best, &at, sizeof(at));
}

/// Divides one answer among the shapes that are most likely in a draw.
void answer(std::int32_t best, std::size_t shapes, const float* likelihoods, double* answers) {
  if (best >= 0) {
    answers[best] += 1;
    return;
  }
  float most = 0;
  std::size_t ties = 0;
  for (std::size_t shape = 0; shape < shapes; ++shape) {
    const float own = likelihoods[lanes * shape];
    ties = own > most ? 1 : ties + (own == most ? 1 : 0);
    most = std::max(most, own);
  }
  for (std::size_t shape = 0; shape < shapes; ++shape) {
    if (likelihoods[lanes * shape] == most) answers[shape] += 1 / static_cast<double>(ties);
  }
}

}  // namespace

Normals::Normals(std::size_t placements, std::size_t size, std::size_t points)
    : points_(std::max<std::size_t>(points / placements, 1)), size_(size) {
  constexpr std::size_t most_kept = std::size_t{1} << 25;  // 128 MiB
  if (placements * noise_parts * points_ * size > most_kept) return;
  kept_.resize(placements);
  parallel_chunks(placements, 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t place = begin; place < end; ++place)
      draw(place, kept_[place]);
  });
}

void Normals::draw(std::size_t placement, std::vector<float>& out) const {
  Random random(Random(placement).next());
  out.resize(noise_parts * points_ * size_);
  for (float& value : out)
    value = random.normal_float();
}

std::span<const float> Normals::at(std::size_t placement, std::vector<float>& scratch) const {
  if (!kept_.empty()) return kept_[placement];
  draw(placement, scratch);
  return scratch;
}

Observer::Observer(const Templates& templates, const Normals& normals)
    : templates_(templates),
      points_(normals.points()),
      blocks_((noise_parts * points_ + lanes - 1) / lanes),
      noise_(templates.placements * blocks_ * templates.size() * lanes) {
  const Root root(templates);
  const std::size_t all = templates.size(), draws = noise_parts * points_;
  parallel_chunks(templates.placements, 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<float> scratch;
    std::vector<float> deviates(root.own.size() * lanes);
    for (std::size_t place = begin; place < end; ++place) {
      const std::span<const float> drawn = normals.at(place, scratch);
      for (std::size_t block = 0; block < blocks_; ++block) {
        const std::size_t first = block * lanes, count = std::min(lanes, draws - first);
        for (std::size_t c = 0; c < root.own.size(); ++c) {
          for (std::size_t lane = 0; lane < count; ++lane)
            deviates[c * lanes + lane] = drawn[(first + lane) * all + root.own[c]];
        }
        root.multiply(deviates.data(), &noise_[(place * blocks_ + block) * all * lanes]);
      }
    }
  });
}

Decisions Observer::decide(double sigma, std::size_t parts) const {
  const std::size_t all = templates_.size(), shapes = templates_.shapes, nodes = templates_.nodes();
  const std::size_t per_shape = templates_.placements * nodes, pairs = parts * points_;
  const auto inverse = static_cast<float>(1 / sigma);
  // Per true template: the answers in each part.
  std::vector<std::vector<double>> answers(all, std::vector<double>(noise_parts * shapes));
  parallel_chunks(all, 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::array<std::int32_t, lanes> best{}, best_mirrored{};
    std::vector<float> scores, sums(shapes * lanes), mirrored(shapes * lanes);
    for (std::size_t truth = begin; truth < end; ++truth) {
      const Candidates candidates = candidates_of(templates_, truth, sigma);
      scores.resize(candidates.templates.size() * lanes);
      const float* noise = &noise_[truth % per_shape / nodes * blocks_ * all * lanes];
      for (std::size_t first = 0; first < pairs; first += lanes, noise += all * lanes) {
        in_lanes([&](auto) PALPA_INLINED {
          likelihoods(candidates, noise, inverse, scores.data(), sums.data());
          likelihoods(candidates, noise, -inverse, scores.data(), mirrored.data());
          most_likely(shapes, sums.data(), best.data());
          most_likely(shapes, mirrored.data(), best_mirrored.data());
        });
        for (std::size_t lane = 0; lane < std::min(lanes, pairs - first); ++lane) {
          double* const of_part = &answers[truth][(first + lane) / points_ * shapes];
          answer(best[lane], shapes, &sums[lane], of_part);
          answer(best_mirrored[lane], shapes, &mirrored[lane], of_part);
        }
      }
    }
  });
  Decisions out;
  out.shares.resize(shapes * shapes);
  for (std::size_t truth = 0; truth < all; ++truth) {
    const std::size_t shape = truth / per_shape;
    const double weight =
        templates_.node_weights[truth % nodes] / static_cast<double>(templates_.placements * points_ * 2);
    for (std::size_t part = 0; part < parts; ++part) {
      for (std::size_t answer = 0; answer < shapes; ++answer)
        out.shares[shape * shapes + answer] +=
            weight * answers[truth][part * shapes + answer] / static_cast<double>(parts);
      out.by_part[part] += weight * answers[truth][part * shapes + shape] / static_cast<double>(shapes);
    }
  }
  for (const double share : out.by_part)
    out.accuracy += share / static_cast<double>(parts);
  return out;
}

namespace {

/// Where the accuracy of these parts of the draws is the wanted one, within `tolerance`: a logarithm of sigma between
/// low and high, beginning at `at`.
double log_sigma_for(const Observer& observer, std::size_t shapes, double accuracy, std::size_t parts, double tolerance,
                     double at, double low, double high) {
  // How far an accuracy is above chance on the scale of normal quantiles is about proportional to 1 / sigma, so that
  // the logarithm of one is almost a straight line over that of the other.
  const double chance = 1 / static_cast<double>(shapes);
  const auto above_chance = [&](double share) { return normal_quantile(share) - normal_quantile(chance); };
  const double wanted = above_chance(accuracy);
  double last_at = 0, last_error = 0;
  for (int i = 0; i < 40 && high - low > 1e-5; ++i) {
    at = at > low && at < high ? at : (low + high) / 2;
    const double found = observer.decide(std::exp(at), parts).accuracy;
    if (std::abs(found - accuracy) < tolerance) return at;
    (found > accuracy ? low : high) = at;
    const double error = std::log(above_chance(std::clamp(found, chance + 1e-4, 1 - 1e-6)) / wanted);
    const double slope = i > 0 && at != last_at ? (error - last_error) / (at - last_at) : -1;
    last_at = at;
    last_error = error;
    at -= error / (slope < -0.1 ? slope : -1);
  }
  return (low + high) / 2;
}

}  // namespace

double sigma_for(const Observer& observer, const Templates& templates, double accuracy) {
  const double spread = spread_of(templates);
  if (!(spread > 0)) return 0;
  const double low = std::log(spread * 1e-2), high = std::log(spread * 1e3);
  const double chance = 1 / static_cast<double>(templates.shapes);
  const double first = std::log(spread / (2 * (normal_quantile(accuracy) - normal_quantile(chance))));
  // A part of the draws finds about where it is.
  const double near = log_sigma_for(observer, templates.shapes, accuracy, 1, 2e-3, first, low, high);
  const double found = log_sigma_for(observer, templates.shapes, accuracy, noise_parts, 3e-5, near, low, high);
  // The accuracy is below the wanted one down to the least noise that was tried.
  return found - low < 1e-4 ? 0 : std::exp(found);
}

}  // namespace palpa::observer
