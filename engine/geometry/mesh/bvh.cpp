#include "geometry/mesh/bvh.hpp"

#include <algorithm>
#include <thread>

#include "base/system/parallel.hpp"
#include "base/system/start_thread.hpp"

namespace palpa::geometry {
namespace {

struct Item {
  float centre[3];
  std::uint32_t triangle;
};

// The distribution of leaves depends only on their number, so every node's place is known before it is built.
class Builder {
 public:
  Builder(const Mesh& mesh, std::vector<Item>& items, std::vector<Bvh::Node>& nodes)
      : mesh_(mesh), items_(items), nodes_(nodes) {}

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, unsigned threads) {
    const std::uint32_t leaves = (end - begin + Bvh::leaf_size - 1) / Bvh::leaf_size;
    if (leaves <= 1) {
      Box box;
      for (std::uint32_t i = begin; i < end; ++i) {
        const glm::uvec3& t = mesh_.triangles[items_[i].triangle];
        for (int k = 0; k < 3; ++k)
          box.add(mesh_.positions[t[k]]);
      }
      nodes_[node] = {box, begin, end, 0};
      return;
    }
    const std::uint32_t first_leaves = leaves / 2, middle = begin + first_leaves * Bvh::leaf_size;
    split(begin, middle, end);
    const std::uint32_t first = node + 1, second = node + 2 * first_leaves;
    std::thread other;
    if (threads > 1) other = try_thread([&] { build(first, begin, middle, threads / 2); });
    if (other.joinable()) {
      build(second, middle, end, threads - threads / 2);
      other.join();
    } else {
      build(first, begin, middle, 1);
      build(second, middle, end, 1);
    }
    Box box = nodes_[first].box;
    box.add(nodes_[second].box.low);
    box.add(nodes_[second].box.high);
    nodes_[node] = {box, begin, end, second};
  }

 private:
  void split(std::uint32_t begin, std::uint32_t middle, std::uint32_t end) {
    float low[3], high[3];
    for (int k = 0; k < 3; ++k)
      low[k] = high[k] = items_[begin].centre[k];
    for (std::uint32_t i = begin; i < end; ++i) {
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], items_[i].centre[k]);
        high[k] = std::max(high[k], items_[i].centre[k]);
      }
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    const auto at = [&](std::uint32_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [axis](const Item& a, const Item& b) {
      return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.triangle < b.triangle;
    });
  }

  const Mesh& mesh_;
  std::vector<Item>& items_;
  std::vector<Bvh::Node>& nodes_;
};

}  // namespace

Bvh::Bvh(const Mesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::vector<Item> items(count);
  parallel_chunks(count, 65'536, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      const Vec3 sum = mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]];
      items[i] = {{static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)},
                  static_cast<std::uint32_t>(i)};
    }
  });
  nodes_.resize(std::size_t{2} * ((count + leaf_size - 1) / leaf_size) - 1);
  Builder(mesh, items, nodes_).build(0, 0, count, count > 20'000 ? worker_count() : 1);
  order_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    order_[i] = items[i].triangle;
}

}  // namespace palpa::geometry
