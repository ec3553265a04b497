#include "touch/contacts/plane_cells.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace palpa::touch {
namespace {

/// A list this short is not worth splitting.
constexpr std::size_t short_list = 1;

std::uint32_t cells_per_axis(std::size_t planes) {
  if (planes <= 128) return 8;
  return planes <= 512 ? 16 : 32;
}

/// Refines one solid's box as an octree whose leaves fill ranges of a flat grid.
class Grid {
 public:
  Grid(const std::vector<LocalPlane>& planes, const Vec3& low, const Vec3& high, std::uint32_t per_axis)
      : planes_(&planes), low_(low), size_((high - low) / static_cast<double>(per_axis)), per_axis_(per_axis) {
    // The error bound of float arithmetic: a few roundings at the size of the box.
    const Vec3 extent = high - low;
    margin_ = 1e-6 * (extent.x + extent.y + extent.z);
    cells.resize(std::size_t{per_axis} * per_axis * per_axis);
  }

  /// Returns false if the lists would exceed `most` planes.
  bool build(std::size_t most) {
    most_ = most;
    std::vector<std::uint32_t> all(planes_->size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
      all[i] = i;
    return refine(glm::uvec3(0), per_axis_, all);
  }

  std::vector<shader::PlaneCell> cells;
  std::vector<std::uint32_t> list;

 private:
  bool refine(const glm::uvec3& first, std::uint32_t width, const std::vector<std::uint32_t>& inherited) {
    // The margin of a hundredth of a cell covers points that rounding moves across a cell's side.
    const std::vector<LocalPlane>& planes = *planes_;
    const Vec3 half = size_ * (0.5 * width + 0.01);
    const Vec3 centre = low_ + size_ * (Vec3(first) + Vec3(0.5 * width));
    double deepest = std::numeric_limits<double>::infinity(), shallowest = deepest, nearest_depth = deepest;
    std::uint32_t nearest = 0;
    for (const std::uint32_t m : inherited) {
      const double depth = planes[m].offset - glm::dot(planes[m].normal, centre);
      const double reach = half_width(planes[m].normal, half);
      deepest = std::min(deepest, depth + reach);
      shallowest = std::min(shallowest, depth - reach);
      if (depth < nearest_depth) {
        nearest_depth = depth;
        nearest = m;
      }
    }
    deepest += margin_;
    shallowest -= margin_;
    std::vector<std::uint32_t> kept;
    if (deepest > 0) {
      for (const std::uint32_t m : inherited) {
        const double behind = planes[m].offset - glm::dot(planes[m].normal, centre) - nearest_depth;
        if (behind <= half_width(planes[m].normal - planes[nearest].normal, half) + margin_) kept.push_back(m);
      }
      if (width > 1 && kept.size() > short_list && shallowest < refined_depth) {
        const std::uint32_t child = width / 2;
        for (std::uint32_t c = 0; c < 8; ++c) {
          const glm::uvec3 step(c & 1U, c >> 1 & 1U, c >> 2);
          if (!refine(first + step * child, child, kept)) return false;
        }
        return true;
      }
    }
    if (list.size() + kept.size() > most_) return false;
    const shader::PlaneCell cell{static_cast<std::uint32_t>(list.size()), static_cast<std::uint32_t>(kept.size()),
                                 rounded_down(shallowest), rounded_up(deepest)};
    list.insert(list.end(), kept.begin(), kept.end());
    for (std::uint32_t z = first.z; z < first.z + width; ++z) {
      for (std::uint32_t y = first.y; y < first.y + width; ++y) {
        const std::size_t row = (std::size_t{z} * per_axis_ + y) * per_axis_ + first.x;
        std::fill_n(cells.begin() + static_cast<std::ptrdiff_t>(row), width, cell);
      }
    }
    return true;
  }

  const std::vector<LocalPlane>* planes_;
  Vec3 low_, size_;
  std::uint32_t per_axis_;
  double margin_ = 0;
  std::size_t most_ = 0;
};

}  // namespace

double half_width(const Vec3& direction, const Vec3& half) {
  return std::abs(direction.x) * half.x + std::abs(direction.y) * half.y + std::abs(direction.z) * half.z;
}

float rounded_down(double value) {
  const float f = static_cast<float>(value);
  return f > value ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

float rounded_up(double value) {
  return -rounded_down(-value);
}

PlaneCells make_plane_cells(const std::vector<LocalPlane>& planes, const Vec3& low, const Vec3& high,
                            std::size_t most_listed) {
  std::uint32_t per_axis = cells_per_axis(planes.size());
  Grid grid(planes, low, high, per_axis);
  if (!grid.build(most_listed)) {
    per_axis = 1;
    grid = Grid(planes, low, high, per_axis);
    grid.build(planes.size());
  }
  return {per_axis, std::move(grid.cells), std::move(grid.list)};
}

}  // namespace palpa::touch
