// The effect of transducers at places of one rigid finger, used instead of the free field's transfer. Solvers that use
// it also focus the sound that the finger scatters (Inoue, Makino and Shinoda 2016).
//
//   g_t = y^T b_t,  A^T y = e
//
// with the matrix A of galerkin.hpp, the sound b_t of transducer t on the finger, and the row e that reads the pressure
// at the focus. One solution per focus gives all transducers. docs/notes/finger-sound.md has the derivation.
//
// A focus inside the finger, such as the centroid of contacts, is moved to the nearest point of the skin. A focus in
// the air stays where it is.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/incident.hpp"
#include "array/field/directivity.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::acoustics {

class FingerTransfer final : public array::Transfer {
 public:
  /// Everything is in one frame; body and layout must outlive it. The body's wave number is that of `air`, and
  /// absorption is included if the air has any.
  FingerTransfer(const RigidBody& body, const array::Layout& layout, const Air& air, array::Directivity directivity);

  /// Replaces the known foci by these: finite, within 100 m. Foci that were known before cost nothing, each of the
  /// others costs a right-hand side. Returns the place of each focus: on the skin, or at the focus itself.
  std::vector<Vec3> aim(std::span<const Vec3> foci);

  /// `foci` must be bit-equal to those passed to aim(). At others nothing arrives, and they request nothing.
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
