// The ellipse's regression against Eigen's generalized eigenvalues, and hostile points; arc lengths against fine
// integration.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "touch/methods/ellipse.hpp"

namespace palpa::touch {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// An ellipse by its axes.
struct Drawn {
  Vec2 centre;
  double major, minor, tilt;
  Vec2 at(double t) const {
    const double x = major * std::cos(t), y = minor * std::sin(t);
    return centre + Vec2(x * std::cos(tilt) - y * std::sin(tilt), x * std::sin(tilt) + y * std::cos(tilt));
  }
};

PlaneMoments moments_of(const std::vector<Vec2>& points) {
  PlaneMoments moments;
  for (const Vec2& p : points)
    moments.add(p);
  return moments;
}

/// Fitzgibbon's own formulation on all six coefficients, S a = w C a, by the symmetric problem of L^-1 C L^-T with S =
/// L L^T. (Eigen's general solver, or matrices of a size known to the compiler, would take it most of a minute.)
Eigen::VectorXd fitzgibbon(const std::vector<Vec2>& points) {
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(6, 6), constraint = scatter;
  for (const Vec2& p : points) {
    const double terms[] = {p.x * p.x, p.x * p.y, p.y * p.y, p.x, p.y, 1};
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column)
        scatter(row, column) += terms[row] * terms[column];
  }
  constraint(0, 2) = constraint(2, 0) = 2;
  constraint(1, 1) = -1;
  const Eigen::LLT<Eigen::MatrixXd> root(scatter);
  const Eigen::MatrixXd half = root.matrixL().solve(constraint);
  const Eigen::MatrixXd symmetric = root.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return root.matrixU().solve(solver.eigenvectors().col(5));  // of the largest eigenvalue
}

TEST(FitEllipse, AgreesWithTheFullEigenvalueProblemOnNoisyPoints) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.08);
  std::uniform_real_distribution<double> angle(0, turn);
  for (int i = 0; i < 100; ++i) {
    const Drawn drawn{{0.2, -0.1}, 1.2, 0.7, angle(random)};
    std::vector<Vec2> points;
    for (int n = 0; n < 40 + i; ++n)
      points.push_back(drawn.at(angle(random)) + Vec2(noise(random), noise(random)));
    const auto fitted = fit_ellipse(moments_of(points));
    ASSERT_TRUE(fitted);
    const auto conic = fitzgibbon(points);
    for (double t = 0; t < turn; t += 0.3) {
      const Vec2 p = fitted->at(t);
      const Eigen::Matrix<double, 6, 1> terms{p.x * p.x, p.x * p.y, p.y * p.y, p.x, p.y, 1};
      const Eigen::Vector2d slope{2 * conic[0] * p.x + conic[1] * p.y + conic[3],
                                  conic[1] * p.x + 2 * conic[2] * p.y + conic[4]};
      ASSERT_NEAR(terms.dot(conic) / slope.norm(), 0, 1e-9) << i;
    }
  }
}

TEST(FitEllipse, RefusesWhatIsNone) {
  EXPECT_FALSE(fit_ellipse({}));
  EXPECT_FALSE(fit_ellipse(moments_of({{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0.5}}))) << "5 points fit any conic";
  EXPECT_FALSE(fit_ellipse(moments_of(std::vector<Vec2>(20, Vec2(0.3, 0.4)))));
  const double nan = std::nan("");
  EXPECT_FALSE(fit_ellipse(moments_of({{0, 0}, {1, 0}, {0, 1}, {nan, 1}, {2, 0.5}, {1, 1}, {3, 2}})));
  EXPECT_FALSE(ellipse_of_moments({}));
  EXPECT_FALSE(ellipse_of_moments(moments_of({{nan, 1}, {1, 2}, {2, 1}})));
}

TEST(FitEllipse, WhateverComesIsAFiniteEllipse) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-2, 2);
  for (int i = 0; i < 2000; ++i) {
    std::vector<Vec2> points;
    const int kind = i % 4;
    for (int n = 0; n < 6 + i % 30; ++n) {
      const double x = place(random), y = place(random);
      points.push_back(kind == 0   ? Vec2(x, y)                       // a patch
                       : kind == 1 ? Vec2(x, 0.5 * x + 1e-9 * y)      // all but a line
                       : kind == 2 ? Vec2(x, x * x)                   // a parabola
                                   : Vec2(x, std::hypot(1.0, x) + 0)  // a branch of a hyperbola
      );
    }
    const auto fitted = fit_ellipse(moments_of(points));
    if (!fitted) continue;
    EXPECT_TRUE(std::isfinite(fitted->semi_major()) && fitted->semi_major() > 0) << i;
    EXPECT_GT(fitted->xx * fitted->yy - fitted->xy * fitted->xy, 0) << i;
  }
}

TEST(Ellipse, ParameterIsTheInverse) {
  const Ellipse ellipse{{0.4, -2}, 1.5, 0.3, 0.8};
  for (double t = 0; t < turn; t += 0.01) {
    EXPECT_NEAR(ellipse.parameter_of(ellipse.at(t)), t, 1e-12);
    EXPECT_NEAR(ellipse.parameter_of(ellipse.centre + 3.0 * (ellipse.at(t) - ellipse.centre)), t, 1e-12);
  }
  EXPECT_EQ(ellipse.parameter_of(ellipse.centre), 0);
}

TEST(ArcSteps, CutIntoPiecesOfEqualLength) {
  for (const double minor : {1.0, 0.5, 0.1, 0.05}) {
    const Ellipse ellipse{{1, 2}, 1, 0, minor};
    const ArcSteps arc(ellipse);
    const auto length = [&](double from, double to) {
      constexpr int pieces = 20000;
      double sum = 0;
      for (int i = 0; i < pieces; ++i) {
        const double t = from + (to - from) * (i + 0.5) / pieces;
        sum += std::hypot(std::sin(t), minor * std::cos(t)) * (to - from) / pieces;
      }
      return sum;
    };
    EXPECT_NEAR(arc.length(), length(0, turn), 1e-4 * arc.length());
    double last = 0;
    for (int n = 1; n <= 10; ++n) {
      const double t = arc.parameter_at(n / 10.0);
      EXPECT_NEAR(length(last, t), arc.length() / 10, 2e-4 * arc.length()) << minor << " " << n;
      EXPECT_NEAR(arc.share_of(t), n / 10.0, 1e-12);
      last = t;
    }
    EXPECT_NEAR(arc.parameter_at(1), turn, 1e-12);
    EXPECT_EQ(arc.parameter_at(0), 0);
  }
}

}  // namespace
}  // namespace palpa::touch
