// From pressures on the faces of a fingertip to what reaches the sites of its afferents.
//
// The skin is a half-space. Distances are measured in a straight line from the site to a face; apart from this, the
// skin's curvature is left out. For the deflection, a face's pressure acts on a disc of the face's area
// (half_space.hpp). For the stress at 0.3 mm, it acts on small triangles, each of which is a point force. The
// deflection from a face is delayed by the time that a surface wave takes from the rim of the disc to the site, in
// whole samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "observer/afferents/half_space.hpp"
#include "observer/afferents/pressure_pattern.hpp"
#include "observer/afferents/response.hpp"
#include "observer/afferents/skin_sites.hpp"

namespace palpa::observer {

enum class Delays { none, waves };

class SkinLoad {
 public:
  /// `body` is the mesh of the sites. The speed of surface waves, m/s, changes only the delays.
  SkinLoad(const geometry::Mesh& body, const SkinSites& sites, Delays delays = Delays::waves,
           double wave_m_s = usual_wave_m_s);

  std::size_t sites() const { return sites_; }
  /// One more than the longest delay in samples.
  std::size_t delays() const { return delays_; }

  /// The stress at each site, N/mm2, from a map of pressures in Pa, one per face of the sites.
  std::vector<double> stress(std::span<const float> map) const;
  /// The parts of the deflection at each site, mm: entry [site * delays() + delay] arrives `delay` samples later.
  std::vector<double> deflections(std::span<const float> map) const;

 private:
  struct Part {
    std::uint32_t face, delay;
    double weight;
  };
  std::size_t sites_, delays_ = 1;
  std::vector<std::size_t> stress_begin_, deflection_begin_;  // per site, and the end
  std::vector<Part> stress_, deflection_;
};

/// What arrives at each site while a pattern plays from time 0 on, on skin at rest.
class SkinUnderPattern {
 public:
  /// `load` must outlive it. `samples` of them are computed.
  SkinUnderPattern(const SkinLoad& load, const PressurePattern& pattern, std::size_t samples);

  /// All pressures are at the pattern's own level.
  SkinMotion motion() const;

  /// The mean stress at each site over the whole cycles that fit into the samples, N/mm2.
  std::vector<double> mean_stress() const;

  /// The deflection of each site in the steady state.
  struct Lines {
    std::vector<double> hz;          ///< multiples of 1 / period, up to 1 kHz
    std::vector<double> amplitudes;  ///< mm, entry [site * hz.size() + line]
  };
  Lines lines() const;

 private:
  std::size_t whole_cycles() const;
  std::vector<double> deflection(std::size_t site, std::size_t samples) const;

  const SkinLoad& load_;
  double period_s_;
  std::size_t samples_;
  std::vector<std::vector<double>> stress_, deflections_;                // per map
  std::vector<std::vector<std::pair<std::uint32_t, double>>> sounding_;  // per sample, and one more
};

}  // namespace palpa::observer
