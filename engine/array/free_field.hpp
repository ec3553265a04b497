// The free field: the sound between transducers and foci with nothing in its way,
//
//   G = D(angle) e^{ikd} / max(d, radius)
//
// in double precision but for the directivity D, which is looked up. Twin: shaders/array/drive/transfer_free.glsl.
#pragma once

#include <vector>

#include "array/directivity.hpp"
#include "array/layout.hpp"
#include "array/medium.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

class FreeField final : public Transfer {
 public:
  /// Of this layout, which outlives whatever is filled. Keeps its table where that is still the right one.
  void set(const Layout& layout, const Medium& medium, Directivity kind);
  /// The phase is within 1e-14 turns of what the distance says.
  void fill(std::span<const FocusSource> foci, Weighting weighting, Columns& columns) const override;
  void fill(std::span<const FocusSource> foci, Weighting weighting, std::size_t first, std::size_t count,
            Columns& columns) const override;

 private:
  const Layout* layout_ = nullptr;
  double turns_per_metre_ = 0;
  /// The directivity's table and what it was made for.
  std::vector<double> table_;
  Directivity kind_ = Directivity::omni;
  double ka_ = -1;
};

}  // namespace palpa::array
