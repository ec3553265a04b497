// The computation of `palpa afferents`: one touch, and the spikes of the afferents in the fingertip.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "experiment/observed_finger.hpp"
#include "geometry/solid.hpp"
#include "observer/afferents/finger_place.hpp"
#include "observer/afferents/models.hpp"
#include "study/plan/plan_method.hpp"

namespace palpa::experiment {

/// The defaults are the command line's.
struct AfferentsTask {
  study::PlanMethod method{.name = "cross-section", .stride = {}};
  double penetration_m = 3e-3;
  observer::FingerPlace place;
  double crest_n = 16e-3;                      ///< sets the level, see Calibration
  bool linear = false;                         ///< the linear pressures instead
  double wave_m_s = observer::usual_wave_m_s;  ///< of surface waves on the skin
  double duration_s = 0.5, bin_s = 5e-3;
};
/// Throws bad_usage if values are out of range or do not fit together.
void check(const AfferentsTask& task);

/// Values by class: SA1, RA, PC.
using ByClass = std::array<double, observer::afferent_classes>;

struct AfferentsResult {
  geometry::Mesh body;  ///< tip at the origin
  observer::SkinSites sites;
  double factor = 1;              ///< on the linear pressures
  double crest_n = 0;             ///< the largest force on the finger, at that level
  std::vector<ByClass> rates_hz;  ///< per site: of the mean afferent of the class
  std::vector<ByClass> spikes;    ///< per bin of time: of all afferents in the fingertip together
  ByClass afferents{};            ///< in the fingertip
  ByClass active{};               ///< share of them that fire at least once
  double bin_s = 0, wave_m_s = 0;
  std::string class_name(std::size_t kind) const;
};

/// Throws bad_input, naming `scene`, if nothing is touched; otherwise as touch_patterns does.
AfferentsResult afferents(const AfferentsTask& task, ObservedFinger& finger, const std::string& scene,
                          const std::vector<geometry::Solid>& solids);

std::string to_json(const AfferentsResult& result);
/// site,x,y,z,area_cm2,sa1_hz,ra_hz,pc_hz: m, afferents of the site.
std::string sites_csv(const AfferentsResult& result);
/// time_s,sa1,ra,pc: spikes of all afferents of the class in the bin that begins then.
std::string times_csv(const AfferentsResult& result);

}  // namespace palpa::experiment
