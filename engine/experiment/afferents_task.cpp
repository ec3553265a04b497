#include "experiment/afferents_task.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/words.hpp"
#include "experiment/level.hpp"
#include "experiment/touch_patterns.hpp"
#include "geometry/haptics.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::experiment {

void check(const AfferentsTask& task) {
  const study::PlanMethod& m = task.method;
  if (m.stride) {
    if (const std::string fault = geometry::stride_fault(m.foci, *m.stride); !fault.empty())
      throw bad_usage("--stride: " + fault);
  }
  if (task.bin_s > task.duration_s) throw bad_usage("--bin is longer than --duration");
}

std::string AfferentsResult::class_name(std::size_t kind) const {
  return std::string(observer::afferent_words[kind].word);
}

AfferentsResult afferents(const AfferentsTask& task, ObservedFinger& finger, const std::string& scene,
                          const std::vector<geometry::Solid>& solids) {
  const array::Layout layout = setup::load_posed_layout(task.method.layout);
  AfferentsResult out{.body = finger.mesh(), .sites = finger.sites(), .rates_hz = {}, .spikes = {}};
  if (!task.linear) out.factor = calibrate_level(finger, layout).factor(task.crest_n);
  const ObservedMethod method{task.method, &layout};
  const TouchPattern touch = touch_patterns(finger, {scene, solids, task.penetration_m}, task.place, {&method, 1})[0];
  if (touch.pattern.slots.empty())
    throw bad_input(scene, "the finger touches nothing there; give another --penetration");
  out.crest_n = out.factor * touch.crest_n;
  out.bin_s = task.bin_s;
  out.wave_m_s = task.wave_m_s;
  const auto samples = static_cast<std::size_t>(std::lround(task.duration_s * observer::afferent_rate_hz));
  const observer::SkinLoad load(out.body, out.sites, observer::Delays::waves, task.wave_m_s);
  const observer::SkinMotion motion = observer::SkinUnderPattern(load, touch.pattern, samples).motion();
  const std::size_t sites = out.sites.positions.size();
  out.rates_hz.resize(sites);
  out.spikes.resize(static_cast<std::size_t>(std::ceil(task.duration_s / task.bin_s - 1e-9)));
  for (const observer::AfferentModel& model : observer::afferent_models()) {
    const auto kind = static_cast<std::size_t>(model.kind);
    const observer::Spikes spikes = observer::respond(motion, model, out.factor, 0, observer::SpikeTimes::yes);
    for (std::size_t s = 0; s < sites; ++s) {
      const double here = observer::afferents_at(out.sites.areas_cm2[s], model.kind);
      out.afferents[kind] += here;
      if (spikes.counts[s] > 0) out.active[kind] += here;
      out.rates_hz[s][kind] +=
          spikes.counts[s] / task.duration_s / static_cast<double>(observer::models_of(model.kind));
      for (const double time : spikes.times[s]) {
        // A spike is stamped with the end of its sample.
        const auto bin = static_cast<std::size_t>((time - 0.5 / observer::afferent_rate_hz) / task.bin_s);
        if (bin < out.spikes.size()) out.spikes[bin][kind] += here;
      }
    }
  }
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind)
    out.active[kind] /= out.afferents[kind];
  return out;
}

namespace {

constexpr const char* class_keys[observer::afferent_classes]{"sa1", "ra", "pc"};

void add_classes(JsonWriter& json, const ByClass& values) {
  json.begin_object(JsonWriter::Style::line);
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind)
    json.key(class_keys[kind]).rounded(values[kind], 10);
  json.end_object();
}

std::string class_cells(const ByClass& values) {
  return fmt::format("{:.10g},{:.10g},{:.10g}", values[0], values[1], values[2]);
}

}  // namespace

std::string to_json(const AfferentsResult& result) {
  JsonWriter json;
  json.begin_object().key("factor").rounded(result.factor, 10).key("crest_n").rounded(result.crest_n, 10);
  json.key("wave_m_s").rounded(result.wave_m_s, 10);
  json.key("afferents");
  add_classes(json, result.afferents);
  json.key("active");
  add_classes(json, result.active);
  json.member("bin_s", result.bin_s).key("spikes").begin_array(JsonWriter::Style::block);
  for (const ByClass& spikes : result.spikes)
    add_classes(json, spikes);
  json.end_array().key("sites").begin_array(JsonWriter::Style::block);
  for (std::size_t s = 0; s < result.sites.positions.size(); ++s) {
    json.begin_object(JsonWriter::Style::line).member("position_m", result.sites.positions[s]);
    json.key("area_cm2").rounded(result.sites.areas_cm2[s], 10).key("rates_hz");
    add_classes(json, result.rates_hz[s]);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::string sites_csv(const AfferentsResult& result) {
  std::string csv = "site,x,y,z,area_cm2,sa1_hz,ra_hz,pc_hz\n";
  for (std::size_t s = 0; s < result.sites.positions.size(); ++s) {
    const Vec3& p = result.sites.positions[s];
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{:.10g},{}\n", s, p.x, p.y, p.z, result.sites.areas_cm2[s],
                   class_cells(result.rates_hz[s]));
  }
  return csv;
}

std::string times_csv(const AfferentsResult& result) {
  std::string csv = "time_s,sa1,ra,pc\n";
  for (std::size_t i = 0; i < result.spikes.size(); ++i) {
    fmt::format_to(std::back_inserter(csv), "{:.10g},{}\n", static_cast<double>(i) * result.bin_s,
                   class_cells(result.spikes[i]));
  }
  return csv;
}

}  // namespace palpa::experiment
