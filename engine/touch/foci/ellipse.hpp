// The ellipse that fits points of a plane best.
//
// Direct least squares after Fitzgibbon, Pilu and Fisher (IEEE TPAMI 21(5), 1999): among all conics
// a x^2 + b x y + c y^2 + d x + e y + f = 0 with 4 a c - b^2 = 1, which are ellipses, the one with the least sum of
// squares over the points; d, e and f are eliminated first, as Halir and Flusser (WSCG 1998) do for stability. It is
// the regression of the paper's reference [7]. Noise makes the fit a little too small, as is known of it.
#pragma once

#include <array>
#include <optional>

#include "base/math.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The plane of a cross-section, through its centroid along w1 and w2, lengths by the contacts' spread. Its second
/// coordinate counts against w2, so that angles run clockwise seen from the tip of w3.
class SectionPlane {
 public:
  explicit SectionPlane(const CrossSection& section);
  Vec2 flat(const glm::vec3& p) const;
  glm::vec3 raised(const Vec2& p) const;

 private:
  Vec3 centroid_, along1_, along2_;
  double unit_;
};

/// centre + shape (cos t, sin t); `shape` is symmetric and positive definite, so that t turns with the plane's own axes
/// even where the ellipse is a circle and has none.
struct Ellipse {
  Vec2 centre{};
  double xx = 0, xy = 0, yy = 0;  ///< shape

  Vec2 at(double t) const;
  /// The parameter of the point in whose direction `p` lies once the ellipse is squeezed to a circle, in [0, 2 pi).
  double parameter_of(const Vec2& p) const;
  double semi_major() const;
  double semi_minor() const;
};

/// Sums of x^i y^j over points, i + j <= 4: all that a fit needs. Best fed with points around the origin at distances
/// of about 1.
struct PlaneMoments {
  std::array<std::array<double, 5>, 5> sums{};  ///< [i][j]
  void add(const Vec2& p);
};

/// Nothing for fewer than 6 points (5 determine a conic, whatever they are), points on a line, or anything that is not
/// finite. The result is always a real ellipse, however badly the points lie on one.
std::optional<Ellipse> fit_ellipse(const PlaneMoments& moments);

/// The ellipse whose points, spread evenly by their parameter, have the mean and the covariance of the points: its
/// semi-axes are sqrt(2) standard deviations. Its parameter is Eq. (5)'s angle. Nothing for points on a line or none.
std::optional<Ellipse> ellipse_of_moments(const PlaneMoments& moments);

/// Parameters that cut an ellipse into pieces of equal arc length, from t = 0.
class ArcSteps {
 public:
  explicit ArcSteps(const Ellipse& ellipse);
  double length() const { return along_.back(); }
  /// Parameter after the given share of the whole length, 0 to 1; off by less than a ten-thousandth of a turn unless
  /// the ellipse is more than 20 times longer than wide.
  double parameter_at(double share) const;
  /// The other way round.
  double share_of(double parameter) const;

 private:
  static constexpr std::size_t pieces = 720;
  std::array<double, pieces + 1> along_{};
};

}  // namespace palpa::touch
