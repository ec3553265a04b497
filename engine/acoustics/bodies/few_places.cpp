#include "acoustics/bodies/few_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>

#include "acoustics/compressed/cluster_tree.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;

/// Larger clusters need fewer places in all, and more time to find them.
constexpr std::uint32_t cluster_size = 640;

/// One row per point source, one column per vertex; real and imaginary parts apart.
class Rows {
 public:
  Rows(std::size_t rows, std::size_t columns) : columns_(columns), re_(rows * columns), im_(rows * columns) {}
  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return re_.size() / columns_; }
  void add(std::size_t row, std::size_t column, Complex value) {
    re_[row * columns_ + column] += value.real();
    im_[row * columns_ + column] += value.imag();
  }
  Complex at(std::size_t row, std::size_t column) const {
    return {re_[row * columns_ + column], im_[row * columns_ + column]};
  }
  /// The products of each column with a column of other rows, conjugated.
  void products(const Rows& other, std::size_t column, std::span<double> re, std::span<double> im) const {
    std::ranges::fill(re, 0);
    std::ranges::fill(im, 0);
    for (std::size_t row = 0; row < rows(); ++row) {
      const Complex with = other.at(row, column);
      const double a = with.real(), b = with.imag();
      const double *const x = &re_[row * columns_], *const y = &im_[row * columns_];
      double *const sum_re = re.data(), *const sum_im = im.data();
      for (std::size_t c = 0; c < columns_; ++c) {
        sum_re[c] += x[c] * a + y[c] * b;
        sum_im[c] += y[c] * a - x[c] * b;
      }
    }
  }

 private:
  std::size_t columns_;
  std::vector<double> re_, im_;
};

/// Even all over the unit sphere.
Vec3 direction(std::size_t i, std::size_t count) {
  const double height = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
  const double turn = 2 * std::numbers::pi * std::fmod(static_cast<double>(i) * (std::numbers::phi - 1), 1.0);
  const double across = std::sqrt(1 - height * height);
  return {across * std::cos(turn), across * std::sin(turn), height};
}

/// p + (i/k) dp/dn of a point source.
Complex arriving(const Vec3& source, const Vec3& at, const Vec3& normal, double k) {
  const Vec3 way = at - source;
  const double r = glm::length(way), along = glm::dot(way, normal) / r;
  // dp/dn = (ik - 1/r) p along, times i/k: -(1 + i / (k r)) p along
  const Complex factor(1 - along, -along / (k * r));
  const Complex p = std::polar(1 / r, k * r);
  return {p.real() * factor.real() - p.imag() * factor.imag(), p.real() * factor.imag() + p.imag() * factor.real()};
}

/// The sound of each source: b at the cluster's vertices, and the right sides there.
struct Sounds {
  Rows values, right_sides;
};

Sounds sounds_at(const RigidBody& body, std::span<const std::uint32_t> vertices) {
  const geometry::Mesh& mesh = body.mesh();
  const double k = body.wave_number();
  std::vector<std::uint32_t> place(mesh.positions.size(), static_cast<std::uint32_t>(vertices.size()));
  Box box;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    place[vertices[v]] = static_cast<std::uint32_t>(v);
    box.add(mesh.positions[vertices[v]]);
  }
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const glm::uvec3& corners = mesh.triangles[face];
    if (std::min({place[corners.x], place[corners.y], place[corners.z]}) == vertices.size()) continue;
    faces.push_back(face);
    for (int c = 0; c < 3; ++c)
      box.add(mesh.positions[corners[c]]);
  }
  const Vec3 centre = 0.5 * (box.low + box.high);
  const double radius = 0.5 * glm::distance(box.low, box.high);
  // Half as many again as a ball of this radius has regular waves that matter.
  const double degree = k * radius + 4;
  const auto count = static_cast<std::size_t>(1.5 * degree * degree);
  const double away = radius + 2 * std::numbers::pi / k;
  Sounds sounds{Rows(count, vertices.size()), Rows(count, vertices.size())};
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 source = centre + away * direction(i, count);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const std::uint32_t vertex = vertices[v];
      sounds.values.add(i, v, arriving(source, mesh.positions[vertex], body.vertex_normals()[vertex], k));
    }
    for (const std::uint32_t face : faces) {
      for (std::size_t sample = 0; sample < 3; ++sample) {
        const std::size_t point = std::size_t{3} * face + sample;
        const Complex sound = body.areas()[point] * arriving(source, body.points()[point], body.normals()[point], k);
        for (std::size_t c = 0; c < 3; ++c) {
          const std::uint32_t to = place[mesh.triangles[face][static_cast<int>(c)]];
          if (to < vertices.size()) sounds.right_sides.add(i, to, hat_at_sample(c, sample) * sound);
        }
      }
    }
  }
  return sounds;
}

/// Columns of Cholesky's factors of the products of all vertices' values, until the rest is small.
class Choice {
 public:
  Choice(const Rows& values, double tolerance, const std::atomic<bool>* give_up) : size_(values.columns()) {
    std::vector<double> rest(size_, 0), re(size_), im(size_);
    for (std::size_t row = 0; row < values.rows(); ++row) {
      for (std::size_t v = 0; v < size_; ++v)
        rest[v] += std::norm(values.at(row, v));
    }
    const double enough = tolerance * tolerance * *std::ranges::max_element(rest);
    while (chosen_.size() < size_) {
      stop_if(give_up);
      const auto pivot = static_cast<std::size_t>(std::ranges::max_element(rest) - rest.begin());
      if (!(rest[pivot] > enough)) break;
      values.products(values, pivot, re, im);
      // The products of the pivot's column with all others are conjugated: entry v is conj(pivot) v.
      for (std::size_t c = 0; c < chosen_.size(); ++c) {
        const Complex with = std::conj(factor(c, pivot));
        const Complex* const column = &factors_[c * size_];
        for (std::size_t v = 0; v < size_; ++v) {
          re[v] -= column[v].real() * with.real() - column[v].imag() * with.imag();
          im[v] -= column[v].real() * with.imag() + column[v].imag() * with.real();
        }
      }
      const double scale = 1 / std::sqrt(rest[pivot]);
      for (std::size_t v = 0; v < size_; ++v) {
        factors_.emplace_back(scale * re[v], scale * im[v]);
        rest[v] -= std::norm(factors_.back());
      }
      rest[pivot] = -1;
      chosen_.push_back(static_cast<std::uint32_t>(pivot));
    }
  }
  const std::vector<std::uint32_t>& chosen() const { return chosen_; }

  /// Replaces the right side, products of each chosen vertex' values, conjugated, by its solution.
  void solve(std::span<Complex> right) const {
    // factor(c, chosen r) is zero for r before c: L L^H, with L(r, c) = conj(factor(c, chosen r)).
    const std::size_t count = chosen_.size();
    for (std::size_t r = 0; r < count; ++r) {
      for (std::size_t c = 0; c < r; ++c)
        right[r] -= std::conj(factor(c, chosen_[r])) * right[c];
      right[r] /= factor(r, chosen_[r]).real();
    }
    for (std::size_t r = count; r-- > 0;) {
      for (std::size_t c = r + 1; c < count; ++c)
        right[r] -= factor(r, chosen_[c]) * right[c];
      right[r] /= factor(r, chosen_[r]).real();
    }
  }

 private:
  Complex factor(std::size_t column, std::size_t vertex) const { return factors_[column * size_ + vertex]; }

  std::size_t size_;
  std::vector<Complex> factors_;
  std::vector<std::uint32_t> chosen_;
};

FewPlaces choose(const RigidBody& body, std::vector<std::uint32_t> vertices, double tolerance,
                 const std::atomic<bool>* give_up) {
  const Sounds sounds = sounds_at(body, vertices);
  stop_if(give_up);
  const Choice choice(sounds.values, tolerance, give_up);
  const std::size_t size = vertices.size(), count = choice.chosen().size();
  FewPlaces places;
  for (const std::uint32_t v : choice.chosen())
    places.chosen.push_back(vertices[v]);
  places.vertices = std::move(vertices);
  std::vector<Complex> products(count * size), right(count);
  std::vector<double> re(size), im(size);
  for (std::size_t s = 0; s < count; ++s) {
    stop_if(give_up);
    sounds.right_sides.products(sounds.values, choice.chosen()[s], re, im);
    for (std::size_t v = 0; v < size; ++v)
      products[s * size + v] = {re[v], im[v]};
  }
  places.shares.resize(count * size);
  for (std::size_t v = 0; v < size; ++v) {
    for (std::size_t s = 0; s < count; ++s)
      right[s] = products[s * size + v];
    choice.solve(right);
    for (std::size_t s = 0; s < count; ++s)
      places.shares[s * size + v] = std::complex<float>(right[s]);
  }
  return places;
}

}  // namespace

std::vector<FewPlaces> few_places(const RigidBody& body, double tolerance, const std::atomic<bool>* give_up) {
  const ClusterTree tree = cluster_tree(body.mesh(), cluster_size);
  std::vector<const Cluster*> leaves;
  for (const Cluster& cluster : tree.clusters) {
    if (cluster.leaf()) leaves.push_back(&cluster);
  }
  std::vector<FewPlaces> places(leaves.size());
  parallel_chunks(leaves.size(), 1, [&](std::size_t leaf, std::size_t, std::size_t) {
    stop_if(give_up);
    const auto from = tree.order.begin();
    places[leaf] = choose(body, {from + leaves[leaf]->begin, from + leaves[leaf]->end}, tolerance, give_up);
  });
  return places;
}

}  // namespace palpa::acoustics
