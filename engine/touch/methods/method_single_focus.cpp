// The paper's baseline (Sec. IV-C): a single focus at the centroid of the contacts. It does not move on the skin, so
// the schedule modulates it.
#include "touch/methods/method.hpp"

namespace palpa::touch {

void place_single_focus(const Finger& finger, Placement& out) {
  out.foci.assign(1, {finger.section.centroid, finger.contact_count});
  out.complete = true;
}

}  // namespace palpa::touch
