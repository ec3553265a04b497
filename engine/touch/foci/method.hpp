// Methods: how a finger's cross-section becomes foci, and which of them sound together. docs/methods.md compares them.
//
// A method is one function in a file of its own, method_NAME.cpp; place_foci picks by name. All of them run on the host
// between the foci of FociPass and the schedule, on either backend, and allocate nothing once their output has
// grown. What order the foci play in, for how long and how loud is the schedule's business (array/schedule.hpp).
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

struct MethodOptions {
  Method method = Method::cross_section;
  /// `ellipse`: foci at equal steps of arc length instead of the ellipse's parameter.
  bool equal_arc = false;
  /// N in place of the finger's own number of sectors; 0: that number. Sectors are then cut anew. At most max_foci.
  std::uint32_t foci = 0;
};

/// What a method makes of a finger. Reused from frame to frame.
struct Placement {
  /// In the order of their angle. `points`: `cross-section`, `multi-focus`: contacts of the sector, 0 meaning that it
  /// is empty (`held`: only now); `ellipse`: contacts nearer to this focus than to others, by their angle;
  /// `single-focus`: all contacts.
  std::vector<Focus> foci;
  /// Every focus has a position, whether or not contacts lie near it.
  bool complete = false;
  bool together = false;  ///< all foci sound in one slot

  /// Whether focus `i` has a position.
  bool has(std::size_t i) const { return complete || foci[i].points != 0 || foci[i].held; }
  /// Nothing moves on the skin: without a modulation it would feel nothing.
  bool still() const { return together || foci.size() == 1; }
};

/// Whether a method looks at the contacts themselves (touch::Detail::contacts), beyond what their finger says of them.
bool needs_contacts(const MethodOptions& options);

/// Places the foci of `finger`, one of `touch`. A point-like finger has one focus at its centroid under every method.
/// Deterministic. `out.foci` has one entry for a point-like finger and for `single-focus`, else N, of which at least
/// one has a position.
void place_foci(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);

// The methods; their finger is not point-like.
void place_cross_section(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);
void place_single_focus(const Finger& finger, Placement& out);
void place_ellipse(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);
void place_multi_focus(const Touch& touch, const Finger& finger, const MethodOptions& options, Placement& out);

/// Length in metres of the closed path that foci run on: of the circle whose inscribed polygon of as many corners is as
/// long as the polygon through the foci, so exact for foci spread evenly on a circle. 0 for fewer than 3 positions.
double perimeter_of(const Placement& placement);

}  // namespace palpa::touch
