#include "viewer/app/staleness.hpp"

#include <algorithm>
#include <utility>

namespace palpa::viewer {
namespace {

bool same_marks(const ViewState& a, const ViewState& b) {
  return a.layers == b.layers && a.explode == b.explode && a.slice == b.slice && a.slice_handles == b.slice_handles &&
         a.picked == b.picked && a.dark == b.dark;
}

}  // namespace

void Staleness::add(Stale what) {
  if (what == Stale::nothing) return;
  what_ = std::max(what_, what);
  dirty_ = true;
  if (what == Stale::surfaces) ++surfaces_version_;
}

void Staleness::look(const ViewState& now) {
  if (same_marks(now, drawn_)) return;
  if (now.explode != drawn_.explode) ++surfaces_version_;
  add(Stale::marks);
}

Stale Staleness::take(const ViewState& now) {
  drawn_ = now;
  return std::exchange(what_, Stale::nothing);
}

}  // namespace palpa::viewer
