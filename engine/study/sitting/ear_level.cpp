#include "study/sitting/ear_level.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "acoustics/air.hpp"
#include "acoustics/field/incident.hpp"
#include "array/drive.hpp"
#include "base/error.hpp"

namespace palpa::study {
namespace {

/// The space in which the objects are felt: 4 cm wide, from their top down to the depth at which sound stops.
std::vector<Vec3> foci_of(const StudyPlan& plan) {
  constexpr double half_width_m = 0.02;
  std::vector<Vec3> foci;
  for (const double y : {0.0, -plan.run.deep_m}) {
    for (const double x : {-half_width_m, 0.0, half_width_m}) {
      for (const double z : {-half_width_m, 0.0, half_width_m})
        foci.emplace_back(x, y, z);
    }
  }
  return foci;
}

/// Places all over the ball, evenly by volume: the directions of a Fibonacci lattice, in radii that grow as cube roots.
std::vector<Vec3> ball_around(const Vec3& centre) {
  constexpr int count = 500;
  std::vector<Vec3> places{centre};
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count, up = 1 - 2 * std::fmod(i * std::numbers::phi, 1.0);
    const double around = 2 * std::numbers::pi * std::fmod(i * std::numbers::sqrt2, 1.0);
    const double flat = std::sqrt(1 - up * up), radius = ear_ball_m * std::cbrt(t);
    places.push_back(centre + radius * Vec3(flat * std::cos(around), up, flat * std::sin(around)));
  }
  return places;
}

array::Layout in_default_pose(const array::Layout& layout) {
  return array::transformed(layout, layout.default_T_world_layout);
}

double level_of(double pascals) {
  constexpr double reference_pa = 20e-6;
  return 20 * std::log10(std::max(pascals, 1e-12) / std::numbers::sqrt2 / reference_pa);
}

}  // namespace

double EarLevel::loudest_db() const {
  return std::max(db[0], db[1]);
}

double equivalent_db(double level_db, double sounding_s) {
  constexpr double day_s = 8 * 3600;
  return level_db + 10 * std::log10(std::max(sounding_s, 1e-9) / day_s);
}

EarLevel predict_ear_level(const StudyPlan& plan, const array::Layout* placed) {
  EarLevel level{.db = {level_of(0), level_of(0)}, .sounding_s = study::sounding_s(plan)};
  std::vector<Vec3> places = ball_around(plan.level.ears[0]);
  const std::size_t per_ear = places.size();
  const std::vector<Vec3> right = ball_around(plan.level.ears[1]);
  places.insert(places.end(), right.begin(), right.end());

  std::set<std::string> layouts;
  for (const PlanMethod& method : plan.methods)
    layouts.insert(method.layout);
  for (const std::string& name : layouts) {
    const array::Layout layout = placed != nullptr ? *placed : in_default_pose(array::load_layout(name));
    const acoustics::Incident incident(layout, acoustics::air_of({}, layout.frequency_hz), array::Directivity::t4010a1);
    const std::vector<Vec3> foci = foci_of(plan);
    acoustics::Strengths strengths;
    for (const Vec3& focus : foci) {
      array::SlotFocus one;
      one.position = focus;
      array::Drive drive = array::drive_for(layout, {&one, 1});
      for (array::TransducerDrive& transducer : drive)
        transducer.amplitude *= static_cast<float>(plan.level.ceiling);
      const acoustics::Strengths own_strengths = acoustics::strengths_of(drive);
      strengths.insert(strengths.end(), own_strengths.begin(), own_strengths.end());
    }
    acoustics::Waves waves;
    incident.at(places, {}, strengths, waves);
    for (std::size_t i = 0; i < waves.pressures.size(); ++i) {
      const double db = level_of(std::abs(waves.pressures[i]));
      if (db > level.loudest_db()) {
        level.focus = foci[i / places.size()];
        level.layout = name;
      }
      double& at_ear = level.db[i % places.size() < per_ear ? 0 : 1];
      at_ear = std::max(at_ear, db);
    }
  }
  return level;
}

const std::vector<EarLimit>& ear_limits() {
  static const std::vector<EarLimit> limits{
      {"IRPA/INIRC 1984, AGNIR 2010", "the public", 100},
      {"IRPA/INIRC 1984, AGNIR 2010", "at work", 110},
      {"Poland", "at work, equivalent for 8 hours", 110},
      {"Poland", "at work, at any time", 130},
      {"ACGIH", "at work, at 40 kHz", 115},
  };
  return limits;
}

void refuse_loud(const StudyPlan& plan, const EarLevel& level, const std::string& signature) {
  if (level.loudest_db() <= plan.level.limit_db || !signature.empty()) return;
  throw bad_usage(fmt::format(
      "{}: {:.1f} dB are predicted at an ear, and the limit of the plan is {:.1f} dB: lower the ceiling of its [level] "
      "from {} to {:.2g}, or move the participant away",
      plan.file, level.loudest_db(), plan.level.limit_db, plan.level.ceiling,
      std::floor(plan.level.ceiling * std::pow(10, (plan.level.limit_db - level.loudest_db()) / 20) * 1000) / 1000));
}

}  // namespace palpa::study
