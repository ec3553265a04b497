#include "experiment/skin_rates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "experiment/afferents_task.hpp"
#include "experiment/level.hpp"
#include "experiment/touch_patterns.hpp"

namespace palpa::experiment {
namespace {

/// The same question about a finger with its tip at its origin.
session::SkinQuestion with_tip_at_origin(session::SkinQuestion question) {
  const auto lowest = std::ranges::min_element(question.finger.positions, {}, [](const Vec3& p) { return p.y; });
  constexpr double at_origin_m = 1e-6;
  if (lowest == question.finger.positions.end() || glm::length(*lowest) < at_origin_m) return question;
  const Vec3 tip = *lowest;
  question.T_world_finger = glm::translate(question.T_world_finger, tip);
  for (Vec3& p : question.finger.positions)
    p -= tip;
  return question;
}

bool same_array(const array::Layout& a, const array::Layout& b) {
  return a.source_level_pa_m == b.source_level_pa_m && a.transducer_radius_m == b.transducer_radius_m &&
         std::ranges::equal(a.transducers, b.transducers, [](const array::Transducer& x, const array::Transducer& y) {
           return x.position == y.position && x.axis == y.axis;
         });
}

/// The rates of the mean afferent of each class, at each site.
std::vector<ByClass> rates_of(const observer::SkinMotion& motion, std::size_t sites, double factor, double duration_s) {
  std::vector<ByClass> rates(sites);
  for (const observer::AfferentModel& model : observer::afferent_models()) {
    const auto kind = static_cast<std::size_t>(model.kind);
    const observer::Spikes spikes = observer::respond(motion, model, factor);
    for (std::size_t s = 0; s < sites; ++s)
      rates[s][kind] += spikes.counts[s] / duration_s / static_cast<double>(observer::models_of(model.kind));
  }
  return rates;
}

/// Each vertex of the fingertip has the rates of the nearest site.
std::vector<ByClass> at_vertices(const geometry::Mesh& mesh, const observer::SkinSites& sites,
                                 const std::vector<ByClass>& rates) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<ByClass> values;
  values.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) {
    if (glm::length(p) > observer::fingertip_reach_m) {
      values.push_back({none, none, none});
      continue;
    }
    values.push_back(rates[observer::nearest_site(sites, p)]);
  }
  return values;
}

}  // namespace

void SkinRates::prepare(const session::SkinQuestion& question, acoustics::BodyCache& bodies,
                        const std::atomic<bool>* give_up) {
  const bool same_finger = finger_ && finger_->mesh().positions == question.finger.positions &&
                           finger_->mesh().triangles == question.finger.triangles &&
                           finger_->air().wave_number() == question.air.wave_number();
  if (same_finger && same_array(layout_, question.layout)) return;
  if (!same_finger) {
    finger_.reset();
    finger_.emplace(question.name, question.air, bodies.of(question.finger, question.air.wave_number(), give_up));
  }
  layout_ = {};  // there is no factor until it is found
  factor_ = calibrate_level(*finger_, question.layout).factor(AfferentsTask{}.crest_n);
  layout_ = question.layout;
}

session::SkinAnswer SkinRates::answer(const session::SkinQuestion& asked, acoustics::BodyCache& bodies,
                                      const std::atomic<bool>* give_up) {
  if (!asked.afferents) return session::answer(asked, bodies, give_up);
  const session::SkinQuestion question = with_tip_at_origin(asked);
  session::SkinAnswer out = session::answer(question, bodies, give_up);
  if (question.plan.schedule.voice_count == 0 || question.layout.transducers.empty()) {
    out.rates.assign(question.finger.positions.size(), ByClass{});
    return out;
  }
  if (!question.plan.cycle.is_listed())
    throw bad_input(question.name, "no rates of afferents: the schedule repeats too late; choose another dwell");
  prepare(question, bodies, give_up);
  const TouchPattern touch = patterns_of(*finger_, question.T_world_finger, question.layout, {&question.plan, 1},
                                         question.drive.directivity, give_up)[0];
  const double duration_s = AfferentsTask{}.duration_s;
  const auto samples = static_cast<std::size_t>(std::lround(duration_s * observer::afferent_rate_hz));
  const observer::SkinMotion motion =
      observer::SkinUnderPattern(finger_->load(observer::Delays::waves), touch.pattern, samples).motion();
  const observer::SkinSites& sites = finger_->sites();
  out.rates = at_vertices(finger_->mesh(), sites, rates_of(motion, sites.positions.size(), factor_, duration_s));
  return out;
}

}  // namespace palpa::experiment
