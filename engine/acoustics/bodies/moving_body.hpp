// The sound of transducers on the skin of a finger that moves: what finger_transfer.hpp computes, quickly enough to
// follow the finger.
//
// In the finger's own frame only the array moves. The sound that arrives at the finger is a sum over few of its
// vertices (few_places.hpp), about a fifth of them. The equations are therefore solved once for the sound at each of
// these places. What arrives at place s then gives the skin's point, with the row e of a point as a sum over the
// unknowns,
//
//   g_t = sum over s of (e . x_s) b_t(s)
//
// with the solution x_s and the transducer's sound b_t(s). A new pose thus needs no equation. Each focus is moved to
// the nearest point of the skin.
#pragma once

#include <atomic>
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::acoustics {

class MovingBody {
 public:
  /// The body's wave number is that of `air`. Absorption is left out, as in the solvers. Throws GivenUp
  /// (base/system/parallel.hpp) soon after `give_up` became true.
  MovingBody(std::shared_ptr<const RigidBody> body, const Air& air, array::Directivity directivity,
             const std::atomic<bool>* give_up = nullptr);

  struct Heard {
    Vec3 place;                               ///< on the skin
    double moved_m = 0;                       ///< from the focus
    std::vector<std::complex<double>> sound;  ///< Pa, of each transducer at full amplitude
  };
  /// Foci and layout are in the finger's frame. The sound is within 0.3 % of finger_transfer.hpp, relative to the
  /// loudest transducer, if transducers are at least a wavelength away from the finger. Throws GivenUp soon after
  /// `give_up` became true.
  std::vector<Heard> hear(std::span<const Vec3> foci, const array::Layout& layout,
                          const std::atomic<bool>* give_up = nullptr) const;

  const RigidBody& body() const { return *body_; }

 private:
  std::shared_ptr<const RigidBody> body_;
  Air air_;
  array::Directivity directivity_;
  BodyPlaces places_;
  std::vector<Vec3> heard_at_, heard_along_;    // the few vertices and their normals
  std::vector<std::complex<float>> responses_;  // entry [vertex * few vertices + few vertex]
};

}  // namespace palpa::acoustics
