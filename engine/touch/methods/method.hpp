// A method turns a finger's cross-section into foci and decides which foci sound together. docs/methods.md compares the
// methods.
//
// place_foci() selects a method by name. One of more than a few lines is a function in its own file, method_NAME.cpp.
// Methods come after the fingers of a frame and before its schedule. They allocate nothing once their output has grown.
// The schedule decides the order of the foci, their dwell and their intensity (array/schedule.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "touch/types.hpp"

namespace palpa::touch {

enum class Method {
  cross_section,  ///< the paper: sectors' centroids, Eq. (6)-(7), one after the other
  single_focus,   ///< the paper's baseline: one focus at the contacts' centroid, modulated
  ellipse,        ///< the paper's reference [7]: points of an ellipse fitted to the contacts, one after the other
  multi_focus,    ///< the paper's reference [12]: the cross-section's foci all at once, modulated
};

inline constexpr Word<Method> method_words[] = {{"cross-section", Method::cross_section},
                                                {"single-focus", Method::single_focus},
                                                {"ellipse", Method::ellipse},
                                                {"multi-focus", Method::multi_focus}};

/// Whether nothing moves on the skin under this method: one focus, or all foci at once.
bool stands_still(Method method);
/// Whether all foci of a finger sound in one slot under this method.
bool sounds_together(Method method);

struct MethodOptions {
  Method method = Method::cross_section;
  /// `ellipse`: foci at equal steps of arc length instead of the ellipse's parameter.
  bool equal_arc = false;
  /// N instead of the finger's own number of sectors; the sectors are then recomputed. 0: the finger's own number. At
  /// most max_foci.
  std::uint32_t foci = 0;
};

/// The result of a method for one finger. Reused from frame to frame.
struct Placement {
  /// In the order of their angle. The meaning of `points` depends on the method. `cross-section` and `multi-focus`: the
  /// contacts of the sector; 0 means that it is empty (if `held`: that it became empty shortly before). `ellipse`: the
  /// contacts that are nearer to this focus than to others by angle. `single-focus`: all contacts.
  std::vector<Focus> foci;
  /// Every focus has a position, whether or not contacts lie near it.
  bool complete = false;
  bool together = false;  ///< all foci sound in one slot; set by place_foci()

  /// Whether focus `i` has a position.
  bool has(std::size_t i) const { return complete || foci[i].points != 0 || foci[i].held; }
  /// Nothing moves on the skin, so the skin would feel nothing without modulation.
  bool still() const { return together || foci.size() == 1; }
};

/// Places the foci of `finger`, which belongs to `touch`. A point-like finger has one focus at its centroid under every
/// method. Deterministic. `out.foci` has one entry for a point-like finger and for `single-focus`, otherwise N entries,
/// at least one with a position.
void place_foci(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);

// The methods. The finger must not be point-like.
void place_cross_section(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);
void place_ellipse(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);

/// Length in metres of the closed path through the foci. It is the length of the circle whose inscribed polygon has the
/// same number of corners and the same length as the polygon through the foci. It is exact for foci spread evenly on a
/// circle. 0 for fewer than 3 positions.
double perimeter_of(const Placement& placement);

}  // namespace palpa::touch
