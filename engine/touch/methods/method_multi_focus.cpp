// All foci of the cross-section at once, as in the paper's reference [12] (Long et al. 2014), which draws an object's
// intersection with the hand with several simultaneous foci and modulates them. The solver determines how well the
// array makes several foci at once.
#include "touch/methods/method.hpp"

namespace palpa::touch {

void place_multi_focus(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out) {
  place_cross_section(touch, finger, options, out);
  out.complete = false;  // an empty sector's focus would only make its neighbour louder
}

}  // namespace palpa::touch
