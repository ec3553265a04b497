#include "observer/decision.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/normal.hpp"
#include "base/random.hpp"
#include "base/system/parallel.hpp"

namespace palpa::observer {
namespace {

/// A column of a matrix L with L L^T = products.
struct RootColumn {
  std::size_t own = 0;  ///< the template that it begins with
  std::vector<float> values;
};

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

/// Cholesky's decomposition of the centred products, in the order of the templates: the same draws then mean much the
/// same for every method, and a part of their errors cancels. A template that lies among earlier ones to 1e-10, the
/// rounding of the sums, adds no direction.
std::vector<RootColumn> root_of(const Templates& templates) {
  const std::size_t n = templates.size();
  std::vector<double> rest = centred(templates);
  std::vector<RootColumn> columns;
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i)
    largest = std::max(largest, rest[i * n + i]);
  for (std::size_t own = 0; own < n; ++own) {
    const double left = rest[own * n + own];
    if (!(left > 1e-10 * largest)) continue;
    std::vector<double> column(n);
    for (std::size_t i = own; i < n; ++i)
      column[i] = rest[i * n + own] / std::sqrt(left);
    for (std::size_t i = own; i < n; ++i) {
      for (std::size_t j = own; j < n; ++j)
        rest[i * n + j] -= column[i] * column[j];
    }
    columns.push_back({own, std::vector<float>(column.begin(), column.end())});
  }
  return columns;
}

/// e^x for x <= 0, within 1e-6 of it; exactly the same on every processor.
inline float exponential(float x) {
  const float turns = std::max(x, -87.0F) * 1.44269504F;
  const float whole = (turns + 12582912.0F) - 12582912.0F;
  const float y = (turns - whole) * 0.693147181F;
  const float e =
      1.0F + y * (1.0F + y * (0.5F + y * (1.0F / 6 + y * (1.0F / 24 + y * (1.0F / 120 + y * (1.0F / 720))))));
  const auto bits = (static_cast<std::int32_t>(whole) + 127) << 23;
  float power;
  std::memcpy(&power, &bits, sizeof(power));
  return e * power;
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
    value = static_cast<float>(random.normal());
}

std::span<const float> Normals::at(std::size_t placement, std::vector<float>& scratch) const {
  if (!kept_.empty()) return kept_[placement];
  draw(placement, scratch);
  return scratch;
}

Observer::Observer(const Templates& templates, const Normals& normals)
    : templates_(templates),
      points_(normals.points()),
      noise_(templates.placements * noise_parts * points_ * templates.size()) {
  const std::vector<RootColumn> root = root_of(templates);
  const std::size_t all = templates.size(), draws = noise_parts * points_;
  parallel_chunks(templates.placements, 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<float> scratch;
    for (std::size_t place = begin; place < end; ++place) {
      const std::span<const float> deviates = normals.at(place, scratch);
      for (std::size_t draw = 0; draw < draws; ++draw) {
        float* const sums = &noise_[(place * draws + draw) * all];
        // A column is zero above its own template.
        for (const RootColumn& column : root) {
          const float deviate = deviates[draw * all + column.own];
          for (std::size_t t = column.own; t < all; ++t)
            sums[t] += deviate * column.values[t];
        }
      }
    }
  });
}

Decisions Observer::decide(double sigma, std::size_t parts) const {
  const std::size_t all = templates_.size(), shapes = templates_.shapes, nodes = templates_.nodes();
  const std::size_t per_shape = templates_.placements * nodes;
  const std::size_t draws = parts * points_ * 2, all_pairs = noise_parts * points_;
  // Per true template: the answers in each part.
  std::vector<std::vector<double>> answers(all, std::vector<double>(noise_parts * shapes));
  parallel_chunks(all, 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<float> base(all), score(all);
    std::vector<std::size_t> best(shapes);  // the shapes that are equally likely
    for (std::size_t truth = begin; truth < end; ++truth) {
      const std::size_t place = truth % per_shape / nodes;
      for (std::size_t t = 0; t < all; ++t) {
        const bool own = t % per_shape / nodes == place;
        const bool used = own == (templates_.placement == Placement::known);
        const double weight = std::log(templates_.node_weights[t % nodes]);
        base[t] = used ? static_cast<float>(weight - templates_.square(truth, t) / (2 * sigma * sigma)) : -1e30F;
      }
      for (std::size_t draw = 0; draw < draws; ++draw) {
        const float* const noise = &noise_[(place * all_pairs + draw / 2) * all];
        const auto inverse = static_cast<float>((draw % 2 == 0 ? 1 : -1) / sigma);
        float largest = -2e30F;
        for (std::size_t t = 0; t < all; ++t) {
          score[t] = base[t] + noise[t] * inverse;
          largest = std::max(largest, score[t]);
        }
        for (std::size_t t = 0; t < all; ++t)
          score[t] = exponential(score[t] - largest);
        std::size_t ties = 0;
        float most = -1;
        for (std::size_t shape = 0; shape < shapes; ++shape) {
          float sum = 0;
          for (std::size_t t = shape * per_shape; t < (shape + 1) * per_shape; ++t)
            sum += score[t];
          if (sum < most) continue;
          ties = sum > most ? 0 : ties;
          best[ties++] = shape;
          most = sum;
        }
        for (std::size_t i = 0; i < ties; ++i)
          answers[truth][draw / (2 * points_) * shapes + best[i]] += 1 / static_cast<double>(ties);
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
