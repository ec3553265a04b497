// The ellipse of best fit to points of a plane.
//
// Direct least squares after Fitzgibbon, Pilu and Fisher (IEEE TPAMI 21(5), 1999). Among all conics a x^2 + b x y + c
// y^2 + d x + e y + f = 0 with 4 a c - b^2 = 1, which are ellipses, the fit is the one with the least sum of squares
// over the points. d, e and f are eliminated first, as in Halir and Flusser (WSCG 1998), for stability. It is the
// regression of the paper's reference [7]. With noise, the fit is a little too small, a known property of this method.
#pragma once

#include <array>
#include <optional>

#include "base/math.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The plane of a cross-section, through its centroid along w1 and w2. Lengths are relative to the contacts' spread.
/// The second coordinate counts against w2, so that angles run clockwise seen from the tip of w3.
class SectionPlane {
 public:
  explicit SectionPlane(const CrossSection& section);
  Vec2 flat(const glm::vec3& p) const;
  glm::vec3 raised(const Vec2& p) const;

 private:
  Vec3 centroid_, along1_, along2_;
  double unit_;
};

/// centre + shape (cos t, sin t); `shape` is symmetric and positive definite, so t turns with the plane's axes even if
/// the ellipse is a circle, which has no axes.
struct Ellipse {
  Vec2 centre{};
  double xx = 0, xy = 0, yy = 0;  ///< shape

  Vec2 at(double t) const;
  /// The parameter of the point that lies in the direction of `p` if the ellipse is squeezed to a circle. In [0, 2 pi).
  double parameter_of(const Vec2& p) const;
  double semi_major() const;
};

/// Sums of x^i y^j over points, i + j <= 4: all the data that a fit needs. The points should lie around the origin at
/// distances of about 1.
struct PlaneMoments {
  std::array<std::array<double, 5>, 5> sums{};  ///< [i][j]
  void add(const Vec2& p);
};

/// Empty for fewer than 6 points (any 5 points determine a conic), points on a line, or values that are not finite. The
/// result is always a real ellipse, however poor the fit is.
std::optional<Ellipse> fit_ellipse(const PlaneMoments& moments);

/// The ellipse whose points, spread evenly by their parameter, have the same mean and covariance as the given points.
/// Its semi-axes are sqrt(2) standard deviations. Its parameter is Eq. (5)'s angle. Empty for points on a line or no
/// points.
std::optional<Ellipse> ellipse_of_moments(const PlaneMoments& moments);

/// Parameters that cut an ellipse into pieces of equal arc length, from t = 0.
class ArcSteps {
 public:
  explicit ArcSteps(const Ellipse& ellipse);
  double length() const { return along_.back(); }
  /// The parameter at which the given share (0 to 1) of the whole length is reached. The error is less than a
  /// ten-thousandth of a turn unless the ellipse is more than 20 times longer than wide.
  double parameter_at(double share) const;
  /// The inverse of parameter_at().
  double share_of(double parameter) const;

 private:
  static constexpr std::size_t pieces = 720;
  std::array<double, pieces + 1> along_{};
};

}  // namespace palpa::touch
