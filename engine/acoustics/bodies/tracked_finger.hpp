// The sound of transducers on the skin of a finger that moves: what finger_transfer.hpp computes, quickly enough to
// follow the finger.
//
// The equations of the finger are solved in its own frame, where only the array moves. Each focus is moved to the
// nearest point of the skin. The sources on the skin (rigid_body.hpp, vertex_sources_of) are at the vertices only,
// which makes the sound 3 % inexact, but hardly changes its phases.
#pragma once

#include <atomic>
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "array/directivity.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::acoustics {

class TrackedFinger {
 public:
  /// The body's wave number is that of `air`. Absorption is left out, as in the solvers.
  TrackedFinger(std::shared_ptr<const RigidBody> body, const Air& air, array::Directivity directivity);

  struct Heard {
    Vec3 place;                               ///< on the skin
    double moved_m = 0;                       ///< from the focus
    std::vector<std::complex<double>> sound;  ///< Pa, of each transducer at full amplitude
  };
  /// Foci and layout are in the finger's frame. Throws GivenUp (base/parallel.hpp) soon after `give_up` became true.
  std::vector<Heard> hear(std::span<const Vec3> foci, const array::Layout& layout,
                          const std::atomic<bool>* give_up = nullptr) const;

  const RigidBody& body() const { return *body_; }

 private:
  std::shared_ptr<const RigidBody> body_;
  Air air_;
  array::Directivity directivity_;
  BodyPlaces places_;
};

}  // namespace palpa::acoustics
