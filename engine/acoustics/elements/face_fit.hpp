// The polynomial of a face (surface_sound.hpp): which vertices give its coefficients, and by which factors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "acoustics/elements/patches.hpp"
#include "acoustics/elements/polynomial.hpp"

namespace palpa::acoustics {

/// A polynomial in the coordinates x . s and x . t from `origin`.
struct FaceFit {
  Vec3 origin, s, t;  ///< s and t are perpendicular and as long as 1 / the polynomial's scale
  std::uint32_t degree = 0;
  bool averaged = false;  ///< whether hat averages (hat_averages.hpp) are fitted, instead of the linear elements
  std::vector<std::uint32_t> vertices;
  /// A coefficient is the sum over the vertices of factors[vertex * terms_of(degree) + coefficient] times the average
  /// or the value there.
  std::vector<float> factors;
};

/// Tables that all fits of a body share.
class FitTables {
 public:
  static constexpr std::size_t samples = 6;

  explicit FitTables(const Patches& body);

  const Patches& body() const { return body_; }
  const Vec3& normal(std::uint32_t face) const { return normals_[face]; }
  /// Samples of six_point_rule() on the curved patch, and the areas that they represent.
  const Vec3& at(std::uint32_t face, std::size_t sample) const { return at_[face * samples + sample]; }
  double area(std::uint32_t face, std::size_t sample) const { return areas_[face * samples + sample]; }
  /// Whether the vertex is on a sharp edge.
  bool edged(std::uint32_t vertex) const { return edged_[vertex] != 0; }

 private:
  const Patches& body_;
  std::vector<Vec3> normals_, at_;
  std::vector<double> areas_;
  std::vector<std::uint8_t> edged_;
};

/// Makes one fit after the other. One per thread.
class FitMaker {
 public:
  explicit FitMaker(const FitTables& tables);
  FaceFit make(std::uint32_t face);

 private:
  /// Numbers from 0 for the members of a changing set, in the order in which they came.
  class Members {
   public:
    explicit Members(std::size_t most) : stamps_(most), places_(most) {}
    void clear() {
      ++stamp_;
      list_.clear();
    }
    bool add(std::uint32_t item) {
      if (stamps_[item] == stamp_) return false;
      stamps_[item] = stamp_;
      places_[item] = static_cast<std::uint32_t>(list_.size());
      list_.push_back(item);
      return true;
    }
    bool has(std::uint32_t item) const { return stamps_[item] == stamp_; }
    std::uint32_t place(std::uint32_t item) const { return places_[item]; }
    const std::vector<std::uint32_t>& list() const { return list_; }

   private:
    std::uint32_t stamp_ = 0;
    std::vector<std::uint32_t> stamps_, places_, list_;
  };

  void choose_faces(std::uint32_t face, const Vec3& normal);
  void add_ring(std::size_t begin, std::size_t end, const Vec3* facing);
  bool fit_averages(FaceFit& fit, const Vec3& normal, double side);
  void fit_areas(FaceFit& fit);
  void solve(FaceFit& fit, LeastSquares& squares);
  Monomials row(const FaceFit& fit, std::uint32_t face, std::size_t sample) const;

  const FitTables& tables_;
  Members faces_, vertices_, used_;
  std::vector<double> factors_;
  std::vector<Monomials> rows_;
  std::vector<double> areas_, cosines_;
};

}  // namespace palpa::acoustics
