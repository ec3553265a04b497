#include "geometry/surface/surface_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/parallel.hpp"
#include "geometry/surface/surface_contest.hpp"
#include "geometry/surface/surface_keep.hpp"
#include "geometry/surface/surface_samples.hpp"
#include "geometry/surface/surface_search.hpp"

namespace palpa::geometry {
namespace {

/// Neither a list this short nor a cell smaller than smallest_cell (metres) is worth dividing.
constexpr std::uint32_t short_list = 8, short_deep_list = 24;
constexpr double smallest_cell = 1e-5;
/// Factor for the total length of all children's lists when a cell is divided. An estimate from measurements, rather
/// too large, because room that is spent too early is missing where lists are longest.
constexpr double growth = 3;
/// Maximum number of cells of the grid.
constexpr std::uint32_t most_cells = 262'144;
/// By how much the reported depth of a deep point may exceed the true one.
constexpr double deep_tolerance = 0.02;
/// Single precision's relative error with a margin for a few operations.
constexpr double rounding = 1e-6;

struct Item {
  std::uint32_t cell;  // its index in the result
  glm::uvec3 at;
  std::uint32_t first, count;  // in the level's lists
  bool deep;
  std::uint8_t stuck;  // how many divisions in a row did not help
};

struct Child {
  std::uint32_t kind = shader::surface_outside;
  std::uint32_t count = 0;  // of the chunk's lists, child after child
  std::uint8_t stuck = 0;
  bool leaf = true;
};

struct ChunkResult {
  std::vector<Child> children;
  std::vector<std::uint32_t> lists;
};

/// State carried along the rows of the grid.
struct Walk {
  std::uint32_t guess = 0;  // nearest to the middle of the last cell
  std::uint64_t steps = 0;
  std::optional<glm::uvec3> last;           // cell whose corners were evaluated
  std::array<std::uint32_t, 4> right = {};  // nearest to the corners shared with the next cell
};

class Builder {
 public:
  Builder(const Bvh& bvh, const SurfaceTriangles& triangles, const Vec3& centre, const Box& box,
          const SurfaceOptions& options)
      : t_(triangles), options_(options) {
    const Vec3 extent = box.high - box.low;
    epsilon_ = rounding * glm::length(extent) / 2;
    const double wanted = std::clamp(static_cast<double>(t_.triangles.size()) * 4,
                                     static_cast<double>(std::min(options.least_cells, most_cells)), most_cells * 1.0);
    const double longest = std::max({extent.x, extent.y, extent.z});
    double side = std::max(std::cbrt(extent.x * extent.y * extent.z / wanted), longest / 1000);
    // The shader multiplies by this float, so it defines the cells.
    const auto density = static_cast<float>(1 / side);
    side = 1 / static_cast<double>(density);
    out_.cell_m = side;
    for (int i = 0; i < 3; ++i) {
      out_.low[i] = static_cast<double>(std::nextafter(static_cast<float>(box.low[i]), -1e30F));
      out_.grid[i] = static_cast<std::uint32_t>(std::ceil((box.high[i] - out_.low[i]) / side + 1e-3));
    }
    search_.emplace(bvh, triangles, centre, epsilon_);
    most_listed_ = std::clamp(t_.triangles.size() * 64, std::size_t{1} << 18, std::size_t{64} << 20);
  }

  SurfaceCells run() {
    build_grid();
    search_.reset();  // frees memory before lists grow
    double side = out_.cell_m;
    for (std::uint32_t level = 0; level < shader::surface_most_levels && !items_.empty(); ++level) {
      divide_level(side, level + 1 < shader::surface_most_levels && side / 2 > std::max(smallest_cell, 400 * epsilon_));
      side /= 2;
    }
    for (const Item& item : items_)
      write_leaf(item);
    return std::move(out_);
  }

 private:
  // ---- the grid: lists from the tree ----

  /// Collects all lists. At most one result exists twice at a time, and results keep no unused memory.
  void collect_lists(std::vector<ChunkResult>& results) {
    std::size_t listed = 0;
    for (const ChunkResult& result : results)
      listed += result.lists.size();
    next_lists_.reserve(listed);
    for (ChunkResult& result : results) {
      next_lists_.insert(next_lists_.end(), result.lists.begin(), result.lists.end());
      std::vector<std::uint32_t>().swap(result.lists);
    }
  }

  void build_grid() {
    const std::size_t count = std::size_t{out_.grid.x} * out_.grid.y * out_.grid.z;
    out_.cells.resize(count);
    constexpr std::size_t chunk = 512;
    std::vector<ChunkResult> results(chunk_count(count, chunk));
    const double side = out_.cell_m;
    const std::uint64_t most_steps =
        options_.spare_steps +
        (options_.deep ? 2 : 1) * (options_.steps_per_cell * count + options_.steps_per_triangle * t_.triangles.size());
    if (sampled_steps(count, side) > most_steps * 3 / 2) refuse(most_steps, count);
    std::atomic<std::uint64_t> all_steps{0};
    Activity work("filling its grid", results.size());
    parallel_chunks(count, chunk, [&](std::size_t number, std::size_t begin, std::size_t end) {
      ChunkResult& result = results[number];
      Walk walk;
      // The distance changes by at most the length of a step, so a cell far from the surface has the same result as
      // some that follow.
      std::size_t same = 0;
      for (std::size_t i = begin; i < end && all_steps <= most_steps; ++i) {
        if (same > 0 && position(i).x != 0) {
          --same;
          result.children.push_back(result.children.back());
          continue;
        }
        double spare = 0;
        result.children.push_back(grid_cell(position(i), side, walk, result.lists, spare));
        same = static_cast<std::size_t>(std::max(spare / side, 0.0));
        all_steps += std::exchange(walk.steps, 0);
      }
      result.lists.shrink_to_fit();
      work.advance();
    });
    log::debug(
        fmt::format("a surface of {} triangles: {} cells, {} steps", t_.triangles.size(), count, all_steps.load()));
    // The sum is the same for any number of threads: either all of it was done, or it was too much.
    if (all_steps > most_steps) refuse(most_steps, count);
    collect_lists(results);
    for (std::size_t i = 0; i < count; ++i)
      take(results[i / chunk].children[i % chunk], static_cast<std::uint32_t>(i), position(i));
    finish_level();
  }

  [[noreturn]] static void refuse(std::uint64_t most_steps, std::size_t cells) {
    throw failure(fmt::format(
        "the boxes of its triangles overlap too much: finding the nearest triangles takes more than the {} steps that "
        "palpa spends on a grid of {} cells; turn the mesh so that its long faces run along an axis, or divide them",
        most_steps, cells));
  }

  /// Estimates the steps for the whole grid from one cell in many, so that impossible grids are refused early. Slightly
  /// too high, because these cells have no neighbours to start from.
  std::uint64_t sampled_steps(std::size_t count, double side) const {
    constexpr std::size_t stride = 127;
    std::uint64_t steps = 0;
    Walk walk;
    std::vector<std::uint32_t> lists;
    for (std::size_t i = stride / 2; i < count; i += stride) {
      double spare = 0;
      lists.clear();
      const Child child = grid_cell(position(i), side, walk, lists, spare);
      const std::uint64_t took = std::exchange(walk.steps, 0);
      if (child.count != 0) steps += took;  // a cell without a list also covers some that follow
    }
    return steps * stride;
  }

  glm::uvec3 position(std::size_t i) const {
    return {i % out_.grid.x, i / out_.grid.x % out_.grid.y, i / out_.grid.x / out_.grid.y};
  }

  /// `spare`: the distance from the cell within which the result is the same.
  Child grid_cell(const glm::uvec3& at, double side, Walk& walk, std::vector<std::uint32_t>& lists,
                  double& spare) const {
    const CellSamples samples(out_.low + Vec3(at) * side, side);
    const glm::vec3 middle = samples.at(13);
    float middle2 = 0;
    const std::uint32_t guess = walk.guess = search_->nearest(middle, walk.guess, middle2, walk.steps);
    const double radius = std::sqrt(3.0) / 2 * side, apart = std::sqrt(middle2) - radius;
    const bool inside = is_inside(t_.triangles[guess], t_.signs[guess], t_.corners, middle);
    if (apart > 4 * epsilon_ && !inside) {
      spare = apart - 8 * epsilon_;
      return {};
    }
    const bool deep = inside && apart >= options_.reach_m + 4 * epsilon_;
    if (deep && !options_.deep) {
      spare = apart - options_.reach_m - 8 * epsilon_;
      return {shader::surface_deep};
    }
    Corners corners;
    Contest contest;
    for (std::size_t c = 0; c < 8; ++c)
      corners[c] = samples.at((c & 1) * 2 + (c >> 1 & 1) * 6 + (c >> 2) * 18);
    contest.add({nearest_point(t_.triangles[guess], middle), guess}, corners, epsilon_, 0);
    const bool next = walk.last && at == *walk.last + glm::uvec3(1, 0, 0);
    const std::array<std::uint32_t, 4> left = walk.right;
    std::uint32_t near = guess;
    std::array<float, 8> corner2;
    for (std::size_t c = 0; c < 8; ++c) {
      if (next && c % 2 == 0) {
        near = left[c / 2];
        corner2[c] = shader::surface_distance2(t_.triangles[near], float3(corners[c]));
      } else {
        near = search_->nearest(corners[c], near, corner2[c], walk.steps);
      }
      if (c % 2 == 1) walk.right[c / 2] = near;
      contest.add({nearest_point(t_.triangles[near], corners[c]), near}, corners, epsilon_, 0);
    }
    walk.last = at;
    if (const auto one = deep ? one_for_all(contest, corner2, apart) : std::nullopt) {
      lists.push_back(*one);
      return {shader::surface_deep, 1};
    }
    const std::size_t before = lists.size();
    search_->gather(contest, corners, lists, walk.steps);
    return {deep ? shader::surface_deep : shader::surface_near, static_cast<std::uint32_t>(lists.size() - before), 0,
            false};
  }

  /// How much farther away than the nearest triangle, squared, another triangle may be to replace it, if all are at
  /// least `apart` away.
  static double slack_of(double apart) { return ((1 + deep_tolerance) * (1 + deep_tolerance) - 1) * apart * apart; }

  /// A triangle whose distance nowhere in a deep cell exceeds the nearest one by more than the tolerance. d^2 - |p|^2
  /// is linear in p for the distance to a point and concave for the distance to a surface. Between the corners, the
  /// former is the interpolation of the corners' values, and the latter at least that. The amount by which one rival is
  /// farther away, squared, is therefore largest at a corner.
  static std::optional<std::uint32_t> one_for_all(const Contest& contest, const std::array<float, 8>& corner2,
                                                  double apart) {
    const double slack = slack_of(apart);
    for (std::size_t r = 0; r < contest.count; ++r) {
      double farther = 0;
      for (std::size_t c = 0; c < 8; ++c)
        farther = std::max(farther, double{contest.to_corner[r][c]} - corner2[c]);
      if (farther < slack) return contest.triangle[r];
    }
    return std::nullopt;
  }

  // ---- levels below: lists from the parents' lists ----

  void divide_level(double side, bool may_divide) {
    const std::uint32_t limit = may_divide ? longest_list_to_keep() : std::numeric_limits<std::uint32_t>::max();
    std::vector<const Item*> divided;
    for (const Item& item : items_) {
      if (item.count > std::max(limit, item.deep ? short_deep_list : short_list) && item.stuck < 2) {
        divided.push_back(&item);
      } else {
        write_leaf(item);
      }
    }
    constexpr std::size_t chunk = 256;
    std::vector<ChunkResult> results(chunk_count(divided.size(), chunk));
    Activity work("dividing its grid's cells", results.size());
    parallel_chunks(divided.size(), chunk, [&](std::size_t number, std::size_t begin, std::size_t end) {
      std::vector<float> scratch;
      for (std::size_t i = begin; i < end; ++i)
        divide(*divided[i], side, scratch, results[number]);
      results[number].lists.shrink_to_fit();
      work.advance();
    });
    collect_lists(results);
    for (std::size_t i = 0; i < divided.size(); ++i) {
      const auto first = static_cast<std::uint32_t>(out_.cells.size());
      out_.cells.resize(out_.cells.size() + 8);
      out_.cells[divided[i]->cell] = {first, shader::surface_divided};
      for (std::uint32_t c = 0; c < 8; ++c)
        take(results[i / chunk].children[i % chunk * 8 + c], first + c,
             divided[i]->at * 2U + glm::uvec3(c & 1U, c >> 1U & 1U, c >> 2U));
    }
    finish_level();
  }

  /// Keeps the total size of all lists within its limit.
  std::uint32_t longest_list_to_keep() const {
    std::vector<std::uint32_t> lengths;
    double total = static_cast<double>(out_.runs.size());
    for (const Item& item : items_) {
      lengths.push_back(item.count);
      total += item.count;
    }
    std::sort(lengths.begin(), lengths.end(), std::greater<>());
    for (const std::uint32_t length : lengths) {
      if (length <= short_list) return short_list;
      total += (growth - 1) * length;
      if (total > static_cast<double>(most_listed_)) return length;
    }
    return short_list;
  }

  void divide(const Item& item, double side, std::vector<float>& d2, ChunkResult& result) const {
    constexpr std::size_t n = CellSamples::count;
    const CellSamples samples(out_.low + Vec3(item.at) * side, side);
    const std::uint32_t* list = lists_.data() + item.first;
    d2.resize(item.count * n);
    std::array<float, n> least;
    std::array<std::uint32_t, n> which{};
    least.fill(std::numeric_limits<float>::max());
    for (std::uint32_t k = 0; k < item.count; ++k) {
      float* d = d2.data() + k * n;
      distances2(t_.triangles[list[k]], samples.x.data(), samples.y.data(), samples.z.data(), n, d);
      for (std::size_t i = 0; i < n; ++i) {
        which[i] = d[i] < least[i] ? k : which[i];
        least[i] = d[i] < least[i] ? d[i] : least[i];
      }
    }
    std::array<Rival, n> rivals;
    std::array<bool, n> known{};
    const auto rival = [&](std::size_t i) {
      if (!known[i]) rivals[i] = {nearest_point(t_.triangles[list[which[i]]], Vec3(samples.at(i))), list[which[i]]};
      known[i] = true;
      return rivals[i];
    };
    for (std::size_t c = 0; c < 8; ++c) {
      const std::size_t corner = (c & 1) + (c >> 1 & 1) * 3 + (c >> 2) * 9, middle = CellSamples::corners + c;
      std::array<std::size_t, 8> at;
      float nearest_corner2 = std::numeric_limits<float>::max();
      for (std::size_t k = 0; k < 8; ++k) {
        at[k] = corner + (k & 1) + (k >> 1 & 1) * 3 + (k >> 2) * 9;
        nearest_corner2 = std::min(nearest_corner2, least[at[k]]);
      }
      const double radius = std::sqrt(3.0) / 4 * side;
      // d^2 - |p - middle|^2 is also concave.
      const double apart =
          std::max(std::sqrt(least[middle]) - radius, std::sqrt(std::max(nearest_corner2 - radius * radius, 0.0)));
      const std::uint32_t nearest_of_middle = list[which[middle]];
      const bool inside =
          is_inside(t_.triangles[nearest_of_middle], t_.signs[nearest_of_middle], t_.corners, samples.at(middle));
      if (apart > 4 * epsilon_ && !inside) {
        result.children.emplace_back();
        continue;
      }
      const bool deep = inside && apart >= options_.reach_m + 4 * epsilon_;
      if (deep && !options_.deep) {
        result.children.push_back({shader::surface_deep});
        continue;
      }
      Corners corners;
      for (std::size_t k = 0; k < 8; ++k)
        corners[k] = samples.at(at[k]);
      const auto filter = [&](double slack) {
        Contest contest;
        contest.add(rival(middle), corners, epsilon_, slack);
        for (const std::size_t k : at)
          contest.add(rival(k), corners, epsilon_, slack);
        // With slack, two triangles could exclude each other, so the rivals themselves stay.
        return keep_unbeaten(contest, slack > 0, {list, item.count}, d2.data() + corner, n, result.lists);
      };
      if (deep) {
        const std::uint32_t kept = filter(slack_of(apart));
        if (kept <= short_deep_list) {
          result.children.push_back({shader::surface_deep, kept});
          continue;
        }
        result.lists.resize(result.lists.size() - kept);
      }
      const std::uint32_t kept = filter(0);
      const bool helped = kept < item.count - item.count / 5;
      result.children.push_back({deep ? shader::surface_deep : shader::surface_near, kept,
                                 static_cast<std::uint8_t>(helped ? 0 : item.stuck + 1), false});
    }
  }

  // ---- results ----

  void take(const Child& child, std::uint32_t cell, const glm::uvec3& at) {
    out_.cells[cell] = {0, child.kind};
    const Item item{cell, at, taken_, child.count, child.kind == shader::surface_deep, child.stuck};
    taken_ += child.count;
    if (child.count == 0) return;
    if (child.leaf) {
      finished_.push_back(item);
    } else {
      next_items_.push_back(item);
    }
  }

  void finish_level() {
    lists_.swap(next_lists_);
    items_.swap(next_items_);
    next_lists_.clear();
    next_items_.clear();
    for (const Item& item : finished_)
      write_leaf(item);
    finished_.clear();
    taken_ = 0;
  }

  void write_leaf(const Item& item) {
    const auto first = static_cast<std::uint32_t>(out_.runs.size());
    const std::uint32_t* list = lists_.data() + item.first;
    for (std::uint32_t k = 0; k < item.count;) {
      std::uint32_t end = k + 1;
      while (end < item.count && list[end] == list[end - 1] + 1 && end - k < shader::surface_longest_run)
        ++end;
      out_.runs.push_back(list[k] | (end - k - 1) << shader::surface_run_bits);
      k = end;
    }
    const auto runs = static_cast<std::uint32_t>(out_.runs.size()) - first;
    out_.longest = std::max(out_.longest, item.count);
    out_.cells[item.cell] = {first, (item.deep ? shader::surface_deep : shader::surface_near) + runs};
  }

  const SurfaceTriangles& t_;
  SurfaceOptions options_;
  double epsilon_ = 0;
  std::optional<SurfaceSearch> search_;
  std::size_t most_listed_ = 0;
  SurfaceCells out_;
  std::vector<Item> items_, next_items_, finished_;
  std::vector<std::uint32_t> lists_, next_lists_;
  std::uint32_t taken_ = 0;
};

}  // namespace

bool is_inside(const shader::SurfaceTriangle& triangle, const shader::SurfaceSigns& signs,
               std::span<const shader::vec4> corners, const glm::vec3& p) {
  const shader::OnAxes on = shader::on_axes(triangle, float3(p));
  const shader::SurfaceFeature feature = shader::surface_feature(triangle, on);
  const std::uint32_t corner = shader::feature_corner(feature);
  if (corner == 3) {
    const std::uint32_t word = feature.side == 0 ? signs.side0 : feature.side == 1 ? signs.side1 : signs.side2;
    return shader::side_sign(feature, on, word) < 0;
  }
  const std::uint32_t index = corner == 0 ? signs.corner0 : corner == 1 ? signs.corner1 : signs.corner2;
  return shader::corner_sign(triangle, on, corner, corners[index]) < 0;
}

SurfaceCells make_surface_cells(const Bvh& bvh, const SurfaceTriangles& triangles, const Vec3& centre, const Box& box,
                                const SurfaceOptions& options) {
  return Builder(bvh, triangles, centre, box, options).run();
}

}  // namespace palpa::geometry
