// The decisions of an ideal observer with one internal noise.
//
// A touch of a shape at a placement is felt as its template plus noise of the standard deviation sigma, the same in all
// directions. The observer knows all templates and sigma, but not the placement. It answers the shape with the largest
// likelihood, averaged over placements; no shape is preferred, so shapes that are equally likely share the answers. The
// placement of the touch itself is left out, for all shapes, so that the observer never knows a touch in advance.
//
//   likelihood of a template t for a felt x = t0 + sigma n:  exp(-|t0 - t|^2 / (2 sigma^2) + n.t / sigma) times a
//   factor that all templates share
//
// Only the products n.t matter: they are normally distributed with the templates' scalar products as covariance. They
// are drawn at random, each with its mirror image. The draws are the same for every sigma, shape and method, and
// independent for each placement.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "observer/templates.hpp"

namespace palpa::observer {

/// Independent parts of the draws: their scatter tells the numerical error.
inline constexpr std::size_t noise_parts = 8;

/// Pairs of draws in each part. With twice as many, the accuracy of no variant changes by 0.005.
inline constexpr std::size_t default_points = 8192;

struct Decisions {
  std::vector<double> shares;  ///< by rows: of the answers to each shape
  double accuracy = 0;
  std::array<double, noise_parts> by_part{};  ///< the accuracy of each part
};

/// Normal deviates that observers with the same number of templates share.
class Normals {
 public:
  /// For templates of this number of placements and size. `points`: pairs of draws in each part, divided among the
  /// placements.
  Normals(std::size_t placements, std::size_t size, std::size_t points = default_points);

  /// Pairs of draws in each part at a placement.
  std::size_t points() const { return points_; }
  std::size_t size() const { return size_; }
  /// One deviate per draw of all parts and template. `scratch` holds them if they are too many to be kept.
  std::span<const float> at(std::size_t placement, std::vector<float>& scratch) const;

 private:
  void draw(std::size_t placement, std::vector<float>& out) const;

  std::size_t points_, size_;
  std::vector<std::vector<float>> kept_;  // by placement; empty if they are too many
};

class Observer {
 public:
  /// `templates` must outlive it, `normals` are for its number of placements and its size.
  Observer(const Templates& templates, const Normals& normals);

  /// From the first `parts` of the draws; `by_part` of the others is 0.
  Decisions decide(double sigma, std::size_t parts = noise_parts) const;

 private:
  const Templates& templates_;
  std::size_t points_, blocks_;
  // [placement][eight pairs of draws][template][pair]: n.t of its first draw; the second is the mirror image
  std::vector<float> noise_;
};

/// The sigma with which the observer's accuracy is `accuracy`; 0 if it is lower even almost without noise.
double sigma_for(const Observer& observer, const Templates& templates, double accuracy);

}  // namespace palpa::observer
