#include "setup/tasks/felt_json.hpp"

#include <glm/vec3.hpp>

#include "acoustics/felt/skin.hpp"
#include "acoustics/felt/tune.hpp"
#include "base/words.hpp"

namespace palpa::setup {
namespace {

void add_spectrum(JsonWriter& json, double perimeter_m, const acoustics::Spectrum& spectrum) {
  json.key("spectrum").begin_object().member("perimeter_m", perimeter_m).member("skin_m", glm::vec3(spectrum.skin));
  json.member("period_s", spectrum.period_s).member("variance", spectrum.variance);
  const acoustics::Felt all = acoustics::felt(spectrum);
  json.member("field", word_of(acoustics::focus_kind_words, spectrum.field));
  json.member("felt_share", all.vibration).member("flutter_share", all.flutter);
  json.key("lines").begin_array(JsonWriter::Style::rows);
  for (const acoustics::Line& line : spectrum.lines) {
    json.begin_object().member("frequency_hz", line.frequency_hz).member("amplitude", line.amplitude);
    json.member("phase_rad", line.phase_rad).member("around", line.around).member("hold", line.hold);
    json.member("felt", acoustics::felt_as_vibration(line)).end_object();
  }
  json.end_array().end_object();
}

void add_tune(JsonWriter& json, const acoustics::Tuned& tuned) {
  json.key("tune").begin_object().member("perimeter_m", tuned.ring.perimeter_m).member("foci", tuned.ring.foci);
  json.member("stride", tuned.ring.stride).member("dwell_s", tuned.ring.dwell_s);
  json.member("field", word_of(acoustics::focus_kind_words, tuned.field));
  json.member("felt_share_before", tuned.before.vibration).member("felt_share", tuned.after.vibration);
  json.member("flutter_share_before", tuned.before.flutter).member("flutter_share", tuned.after.flutter).end_object();
}

}  // namespace

void add_felt(JsonWriter& json, const session::ScheduledFinger& finger, const acoustics::Spectrum* spectrum) {
  if (finger.tuned) add_tune(json, *finger.tuned);
  if (spectrum) add_spectrum(json, finger.perimeter_m, *spectrum);
}

}  // namespace palpa::setup
