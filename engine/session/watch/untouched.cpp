#include "session/watch/untouched.hpp"

namespace palpa::session {

void write_untouched(const UntouchedStats& untouched, JsonWriter& json) {
  constexpr int digits = 6;
  json.key("untouched").begin_object();
  if (untouched.solid.empty()) {
    json.key("solid").null().key("distance_mm").null();
  } else {
    json.member("solid", untouched.solid).key("distance_mm").rounded(untouched.distance_m * 1e3, digits);
  }
  json.member("inside", untouched.inside).end_object();
}

}  // namespace palpa::session
