// What transducers do at places of one rigid finger, in the place of the free field's transfer: solvers that are given
// it focus the sound that the finger scatters, too (Inoue, Makino and Shinoda 2016).
//
// By reciprocity one solution of the boundary elements' transposed system per focus tells it of all transducers at
// once. With the system A u = b (galerkin.hpp), b = sum over transducers of s_t b_t what their sound gives on the
// finger, and the row e that reads the pressure at the focus from the unknowns u,
//
//   p = e^T u = sum over transducers of s_t g_t,   g_t = y^T b_t,   A^T y = e:
//
// transposed, not conjugated. The phases -arg g_t then bring the whole array's sound there in phase; at full amplitude
// no drive is louder there.
//
// Within the finger there is no pressure: a focus there, as the centroid of contacts is, stands for the point of the
// skin that is nearest to it. A focus in the air stays where it is.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/incident.hpp"
#include "array/directivity.hpp"
#include "array/layout.hpp"
#include "array/transfer.hpp"

namespace palpa::acoustics {

class FingerTransfer final : public array::Transfer {
 public:
  /// All in one frame; body and layout outlive it. The body's wave number is that of `air`, and absorption counts if
  /// the air has any.
  FingerTransfer(const RigidBody& body, const array::Layout& layout, const Air& air, array::Directivity directivity);

  /// From now on it knows these foci, and no others: finite, within 100 m. Those that it knew already cost nothing, the
  /// others a right-hand side each. The place of each of them: on the skin, or where the focus is.
  std::vector<Vec3> aim(std::span<const Vec3> foci);

  /// Foci as they were aimed at, to the last bit; of others nothing arrives, and they ask for nothing.
  void fill(std::span<const array::FocusSource> foci, array::Weighting weighting,
            array::Columns& columns) const override;
  void fill(std::span<const array::FocusSource> foci, array::Weighting weighting, std::size_t first, std::size_t count,
            array::Columns& columns) const override;

 private:
  struct Aim {
    Vec3 focus, place;
    std::vector<std::complex<double>> sound;  ///< g: Pa, of each transducer at full amplitude
  };
  void hear(std::span<Aim* const> aims) const;
  const Aim* find(const Vec3& focus) const;

  const RigidBody& body_;
  const array::Layout& layout_;
  Incident incident_;
  BodyPlaces places_;
  std::vector<Aim> aims_;
};

}  // namespace palpa::acoustics
