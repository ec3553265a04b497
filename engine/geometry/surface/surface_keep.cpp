#include "geometry/surface/surface_keep.hpp"

#include <algorithm>
#include <array>

#include "base/lanes.hpp"

namespace palpa::geometry {
namespace {

/// A child's eight corners are four pairs of neighbours among its parent's 27 corners. These are the pairs' offsets
/// from the child's first corner.
constexpr std::array<std::size_t, 4> pair_at = {0, 3, 9, 12};

[[gnu::always_inline]] inline std::array<Lanes4::Float, 2> corners_of(Lanes4, const float* d) {
  const auto two = [d](std::size_t k) { return load_lanes<Lanes4>(d + pair_at[k]); };
  return {__builtin_shufflevector(two(0), two(1), 0, 1, 4, 5), __builtin_shufflevector(two(2), two(3), 0, 1, 4, 5)};
}
[[gnu::always_inline]] inline std::array<Lanes8::Float, 1> corners_of(Lanes8, const float* d) {
  const std::array<Lanes4::Float, 2> parts = corners_of(Lanes4{}, d);
  return {__builtin_shufflevector(parts[0], parts[1], 0, 1, 2, 3, 4, 5, 6, 7)};
}

bool is_rival(const Contest& contest, std::uint32_t triangle) {
  const auto end = contest.triangle.begin() + static_cast<std::ptrdiff_t>(contest.count);
  return std::find(contest.triangle.begin(), end, triangle) != end;
}

/// Returns the end of the written list.
template <class L>
[[gnu::always_inline]] inline std::uint32_t* keep_with(const Contest& contest, bool rivals_stay,
                                                       std::span<const std::uint32_t> list, const float* d2,
                                                       std::size_t stride, std::uint32_t* out) {
  for (const std::uint32_t triangle : list) {
    const bool beaten = contest.beats<L>(corners_of(L{}, d2));
    *out = triangle;
    out += !beaten || (rivals_stay && is_rival(contest, triangle)) ? 1 : 0;
    d2 += stride;
  }
  return out;
}

}  // namespace

std::uint32_t keep_unbeaten(const Contest& contest, bool rivals_stay, std::span<const std::uint32_t> list,
                            const float* d2, std::size_t stride, std::vector<std::uint32_t>& kept) {
  const std::size_t before = kept.size();
  kept.resize(before + list.size());
  const std::uint32_t* end = in_lanes([&]<class L>(L) PALPA_INLINED {
    return keep_with<L>(contest, rivals_stay, list, d2, stride, kept.data() + before);
  });
  kept.resize(static_cast<std::size_t>(end - kept.data()));
  return static_cast<std::uint32_t>(kept.size() - before);
}

}  // namespace palpa::geometry
