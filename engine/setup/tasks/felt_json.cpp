#include "setup/tasks/felt_json.hpp"

#include <glm/vec3.hpp>

#include "acoustics/felt/skin.hpp"
#include "acoustics/felt/tune.hpp"
#include "base/words.hpp"

namespace palpa::setup {
namespace {

JsonRows<acoustics::Line> line_rows() {
  using Line = acoustics::Line;
  return JsonRows<Line>()
      .value("frequency_hz", [](const Line& l) { return l.frequency_hz; })
      .value("amplitude", [](const Line& l) { return l.amplitude; })
      .value("phase_rad", [](const Line& l) { return l.phase_rad; })
      .value("around", [](const Line& l) { return l.around; })
      .value("hold", [](const Line& l) { return l.hold; })
      .value("felt", [](const Line& l) { return acoustics::felt_as_vibration(l); });
}

JsonRows<FeltFinger> spectrum_rows() {
  using Finger = FeltFinger;
  return JsonRows<Finger>()
      .value("perimeter_m", [](const Finger& f) { return f.scheduled.perimeter_m; })
      .value("skin_m", [](const Finger& f) { return glm::vec3(f.spectrum->skin); })
      .value("period_s", [](const Finger& f) { return f.spectrum->period_s; })
      .value("variance", [](const Finger& f) { return f.spectrum->variance; })
      .value("field", [](const Finger& f) { return word_of(acoustics::focus_kind_words, f.spectrum->field); })
      .value("felt_share", [](const Finger& f) { return acoustics::felt(*f.spectrum).vibration; })
      .value("flutter_share", [](const Finger& f) { return acoustics::felt(*f.spectrum).flutter; })
      .objects(
          "lines", line_rows(), [](const Finger& f) { return &f.spectrum->lines; }, JsonWriter::Style::rows);
}

JsonRows<acoustics::Tuned> tune_rows() {
  using Tuned = acoustics::Tuned;
  return JsonRows<Tuned>()
      .value("perimeter_m", [](const Tuned& t) { return t.ring.perimeter_m; })
      .value("foci", [](const Tuned& t) { return t.ring.foci; })
      .value("stride", [](const Tuned& t) { return t.ring.stride; })
      .value("dwell_s", [](const Tuned& t) { return t.ring.dwell_s; })
      .value("field", [](const Tuned& t) { return word_of(acoustics::focus_kind_words, t.field); })
      .value("felt_share_before", [](const Tuned& t) { return t.before.vibration; })
      .value("felt_share", [](const Tuned& t) { return t.after.vibration; })
      .value("flutter_share_before", [](const Tuned& t) { return t.before.flutter; })
      .value("flutter_share", [](const Tuned& t) { return t.after.flutter; });
}

}  // namespace

const JsonRows<FeltFinger>& felt_rows() {
  using Finger = FeltFinger;
  static const auto rows =
      JsonRows<Finger>()
          .object("tune", tune_rows(),
                  [](const Finger& f) { return f.scheduled.tuned ? &*f.scheduled.tuned : nullptr; })
          .object("spectrum", spectrum_rows(), [](const Finger& f) { return f.spectrum ? &f : nullptr; });
  return rows;
}

}  // namespace palpa::setup
