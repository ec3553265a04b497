// The cost of the methods and of tuning on the host, for one finger of a frame.
#include <fmt/format.h>

#include <glm/geometric.hpp>

#include "acoustics/felt/tune.hpp"
#include "acoustics/field/array_field.hpp"
#include "base/error.hpp"
#include "base/system/now.hpp"
#include "bench/bench.hpp"
#include "geometry/files/ply.hpp"
#include "session/plan/voice.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"
#include "touch/methods/method.hpp"
#include "touch/stage.hpp"

namespace palpa::bench {
namespace {

/// Median of many batches, per call.
template <typename Work>
Row timed(const Context& context, const std::string& name, const std::string& stage, Work work,
          std::uint32_t batch = 20) {
  std::vector<double> samples;
  for (std::uint32_t run = 0; run < context.runs; ++run) {
    const double begin_ms = now_ms();
    for (std::uint32_t i = 0; i < batch; ++i)
      work();
    samples.push_back((now_ms() - begin_ms) / batch);
    context.progress(name, run + 1, context.runs);
  }
  return make_row("touch", name, stage, samples);
}

/// Foci must lie among the contacts: within the contacts' farthest distance from the centroid, those of an ellipse a
/// little beyond it.
bool plausible(const touch::Touch& touch, const touch::Finger& finger, const touch::Placement& placement) {
  float farthest = 0;
  for (const touch::Contact& contact : touch.contacts)
    farthest = std::max(farthest, glm::distance(contact.position, finger.section.centroid));
  for (std::size_t i = 0; i < placement.foci.size(); ++i) {
    if (!placement.has(i)) continue;
    if (!(glm::distance(placement.foci[i].position, finger.section.centroid) <= 1.2F * farthest)) return false;
  }
  return !placement.foci.empty();
}

}  // namespace

void measure_methods(const Context& context, std::vector<Row>& rows) {
  std::vector<glm::vec3> points;
  for (const Vec3& p : geometry::read_ply(setup::find_asset("finger.ply")).positions)
    points.emplace_back(p.x, p.y - 0.003, p.z);
  touch::Touch touch;
  touch::Stage(setup::load_solids(setup::find_asset("cube.glb"), {})).touch(sensing::numbered(points), touch);
  if (touch.finger_count != 1) wrong("the finger does not touch the cube");
  const touch::Finger& finger = touch.fingers[0];
  const std::string name = fmt::format("{} contacts", finger.contact_count);
  touch::Placement placement;
  for (const auto& [word, method] : touch::method_words) {
    const touch::MethodOptions options{.method = method};
    const std::string stage(word);
    touch::place_foci(touch, finger, options, placement);
    if (!plausible(touch, finger, placement)) throw failure("bench: " + stage + " puts foci far from the contacts");
    rows.push_back(timed(context, name, stage, [&] { touch::place_foci(touch, finger, options, placement); }));
  }
  touch::place_foci(touch, finger, {}, placement);
  const acoustics::Ring ring{touch::perimeter_of(placement), 10, 3, 1.5e-3};
  rows.push_back(timed(context, name, "tune", [&] { acoustics::tune(ring); }));
  // In the loop, a finger that has rested is evaluated in every frame.
  acoustics::StrideTuner strides;
  double time_s = 0;
  rows.push_back(timed(context, name, "stride", [&] { strides.stride_for(0, ring, time_s += 1); }));

  const array::Layout layout = setup::load_posed_layout("paper");
  const acoustics::ArrayField field(layout, {});
  array::Voice voice;
  session::make_voice(placement, 0, 0, {}, voice);
  const std::string of_array = name + " in paper";
  const acoustics::SpectrumOptions spectrum{.field = &field};
  rows.push_back(timed(
      context, of_array, "spectrum", [&] { acoustics::spectrum_of(voice, voice.dwell_s, spectrum); }, 1));
  const acoustics::TuneOptions tuning{.spectrum = spectrum};
  rows.push_back(timed(
      context, of_array, "tune", [&] { acoustics::tune(ring, tuning, voice.foci); }, 1));
  // In the loop, a separate thread does this beside the frames, twice a second for each finger.
  rows.push_back(timed(
      context, of_array, "stride", [&] { acoustics::PathField(field, voice.foci).harmonics(10); }, 1));
}

}  // namespace palpa::bench
