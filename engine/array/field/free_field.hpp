// The free field: the sound between transducers and foci without obstacles,
//
//   G = D(angle) e^{ikd} / max(d, radius)
//
// in double precision except for the directivity D, which comes from a table. Twin:
// shaders/array/drive/transfer_free.glsl.
#pragma once

#include <vector>

#include "array/field/directivity.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/medium.hpp"

namespace palpa::array {

class FreeField final : public Transfer {
 public:
  /// `layout` must outlive the use of fill. Keeps its table if it is still valid.
  void set(const Layout& layout, const Medium& medium, Directivity kind);
  /// The phase is within 1e-14 turns of the exact value for the distance.
  void fill(std::span<const FocusSource> foci, Weighting weighting, Columns& columns) const override;
  void fill(std::span<const FocusSource> foci, Weighting weighting, std::size_t first, std::size_t count,
            Columns& columns) const override;

 private:
  const Layout* layout_ = nullptr;
  double turns_per_metre_ = 0;
  /// The directivity's table and its parameters.
  std::vector<double> table_;
  Directivity kind_ = Directivity::omni;
  double ka_ = -1;
};

}  // namespace palpa::array
