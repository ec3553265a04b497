#include "acoustics/boundary/near_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/geometric.hpp>
#include <mutex>

#include "acoustics/boundary/near_rules.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "base/activity.hpp"
#include "base/log.hpp"
#include "base/system/parallel.hpp"
#include "geometry/mesh/bvh.hpp"

namespace palpa::acoustics {
namespace {

using geometry::Mesh;

constexpr std::size_t patches_per_job = 64;

struct Ball {
  Vec3 centre;
  double size;  // longest side
};

/// Finds near patches with a tree of boxes.
class Neighbours {
 public:
  explicit Neighbours(const Mesh& mesh) : tree_(mesh), longest_(tree_.nodes().size()) {
    balls_.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
      const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
      balls_.push_back({(a + b + c) / 3.0, std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)})});
    }
    for (std::size_t n = longest_.size(); n-- > 0;) {
      const geometry::Bvh::Node& node = tree_.nodes()[n];
      if (node.second != 0) {
        longest_[n] = std::max(longest_[n + 1], longest_[node.second]);
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        longest_[n] = std::max(longest_[n], balls_[tree_.order()[i]].size);
    }
  }

  const Vec3& centre(std::size_t face) const { return balls_[face].centre; }

  /// Calls `found` with every patch near that one, including itself.
  template <class Found>
  void each(std::size_t face, const Found& found) const {
    const Ball& own = balls_[face];
    std::array<std::uint32_t, 64> stack{};
    std::size_t depth = 1;
    while (depth > 0) {
      const std::uint32_t n = stack[--depth];
      const geometry::Bvh::Node& node = tree_.nodes()[n];
      const double most = near_reach * std::max(own.size, longest_[n]);
      if (!(geometry::distance2(node.box, own.centre) < most * most)) continue;
      if (node.second != 0) {
        stack[depth++] = n + 1;
        stack[depth++] = node.second;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const Ball& other = balls_[tree_.order()[i]];
        const double near = near_reach * std::max(own.size, other.size);
        const Vec3 way = own.centre - other.centre;
        if (glm::dot(way, way) < near * near) found(tree_.order()[i]);
      }
    }
  }

 private:
  geometry::Bvh tree_;
  std::vector<Ball> balls_;
  std::vector<double> longest_;  // by node: of the patches below it
};

void find_pairs(const Neighbours& neighbours, std::size_t count, NearPairs& pairs) {
  std::vector<std::vector<std::uint32_t>> found(count);
  parallel_chunks(count, patches_per_job, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      neighbours.each(t, [&](std::uint32_t other) { found[t].push_back(other); });
      std::ranges::sort(found[t]);
    }
  });
  pairs.first.push_back(0);
  for (const std::vector<std::uint32_t>& trials : found) {
    pairs.trial.insert(pairs.trial.end(), trials.begin(), trials.end());
    pairs.first.push_back(static_cast<std::uint32_t>(pairs.trial.size()));
  }
}

NearPatch relative(const Patch& patch, const Vec3& origin) {
  NearPatch out;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 c = i == 0 ? patch.c[0] - origin : patch.c[i];
    for (int axis = 0; axis < 3; ++axis)
      out.c[i][axis] = static_cast<float>(c[axis]);
  }
  return out;
}

/// Half of the hat functions' products over a patch.
Block half_of_itself(const Patch& patch) {
  Block block{};
  for (const TriangleSample& s : six_point_rule()) {
    const std::array<double, 3> hat{1 - s.u - s.v, s.u, s.v};
    const double area = s.weight * glm::length(patch.area_vector(s.u, s.v));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        block[3 * i + j] += static_cast<float>(0.5 * hat[i] * hat[j] * area);
    }
  }
  return block;
}

}  // namespace

std::uint64_t near_pair_count(const Mesh& mesh) {
  const Neighbours neighbours(mesh);
  std::vector<std::uint64_t> counts(chunk_count(mesh.triangles.size(), patches_per_job));
  parallel_chunks(mesh.triangles.size(), patches_per_job, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      neighbours.each(t, [&](std::uint32_t) { ++counts[chunk]; });
  });
  std::uint64_t sum = 0;
  for (const std::uint64_t count : counts)
    sum += count;
  return sum;
}

NearPairs near_pairs(const Patches& body, double wave_number, const std::atomic<bool>* give_up) {
  static const NearRules rules;
  const Mesh& mesh = body.mesh;
  const Neighbours neighbours(mesh);
  NearPairs pairs;
  find_pairs(neighbours, mesh.triangles.size(), pairs);
  pairs.blocks.resize(pairs.trial.size());
  std::mutex mutex;
  Activity activity("sampling neighbouring faces", mesh.triangles.size());
  parallel_chunks(mesh.triangles.size(), patches_per_job, [&](std::size_t, std::size_t begin, std::size_t end) {
    PairTable cut;
    for (std::size_t t = begin; t < end; ++t) {
      stop_if(give_up);
      const NearPatch test = relative(body.patches[t], neighbours.centre(t));
      for (std::uint32_t entry = pairs.first[t]; entry < pairs.first[t + 1]; ++entry) {
        const std::uint32_t other = pairs.trial[entry];
        if (other < t) continue;  // already handled from its side
        bool resolved = true;
        const PairTable* table = rules.touching(mesh.triangles[t], mesh.triangles[other]);
        if (table == nullptr) table = &rules.apart(body.patches[t], body.patches[other], cut, resolved);
        if (!resolved) {
          const std::lock_guard lock(mutex);
          const std::array<std::uint32_t, 2> both{static_cast<std::uint32_t>(t), other};
          pairs.unresolved = std::min(pairs.unresolved.value_or(both), both);
        }
        Block exchanged;
        near_blocks(test, relative(body.patches[other], neighbours.centre(t)), *table, static_cast<float>(wave_number),
                    pairs.blocks[entry], exchanged);
        if (other == t) {
          const Block half = half_of_itself(body.patches[t]);
          for (std::size_t i = 0; i < half.size(); ++i)
            pairs.blocks[entry][i] += half[i];
        } else {
          const auto from = pairs.trial.begin() + pairs.first[other], to = pairs.trial.begin() + pairs.first[other + 1];
          const auto mirror = std::lower_bound(from, to, static_cast<std::uint32_t>(t)) - pairs.trial.begin();
          pairs.blocks[static_cast<std::size_t>(mirror)] = exchanged;
        }
      }
    }
    activity.advance(end - begin);
  });
  return pairs;
}

void warn_of_unresolved(const NearPairs& pairs) {
  if (!pairs.unresolved) return;
  log::warning(
      fmt::format("The surface nearly touches itself: faces {} and {} are less than a twelfth of their sides apart; "
                  "their effect on each other is less exact",
                  (*pairs.unresolved)[0], (*pairs.unresolved)[1]));
}

}  // namespace palpa::acoustics
