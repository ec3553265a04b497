#include "array/layouts/as_built.hpp"

#include <cassert>

#include "base/random.hpp"

namespace palpa::array {
namespace {

/// Standard normal numbers, scaled. A number whose scale is 0 is skipped, which costs less than computing it.
class Normals {
 public:
  Normals(std::uint64_t seed, std::uint32_t draw) : random_(Random(Random(seed).next() + draw).next()) {}

  double next(double deviation) {
    if (deviation > 0) return deviation * random_.normal();
    random_.next();
    return 0;
  }

 private:
  Random random_;
};

}  // namespace

AsBuilt as_built(const Layout& layout, const Drive& drive, const Spread& spread, std::uint64_t seed,
                 std::uint32_t draw) {
  assert(drive.size() == layout.transducers.size());
  Normals normals(seed, draw);
  AsBuilt built{.layout = layout, .drive = drive, .temperature = normals.next(spread.temperature)};
  for (std::size_t t = 0; t < drive.size(); ++t) {
    TransducerDrive& one = built.drive[t];
    one.amplitude = static_cast<float>(one.amplitude * (1 + normals.next(spread.amplitude)));
    one.phase = static_cast<float>(one.phase + normals.next(spread.phase_rad));
    for (int axis = 0; axis < 3; ++axis)
      built.layout.transducers[t].position[axis] += normals.next(spread.position_m);
  }
  return built;
}

}  // namespace palpa::array
