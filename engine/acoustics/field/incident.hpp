// What drives sound like at many points at once, in free air: their pressure and, where asked, its slope.
//
//   p(x) = level * sum over transducers of s_t G_t(x),   G_t(x) = D(angle) e^{(ik - alpha) r} / max(r, radius)
//
// and the slope is n . grad p, that of directivity and absorption included. Drives that sound at the same points share
// G, so that ten cost little more than one. All cores; phases in double precision, all else in single: within 1e-5 of
// pressure_at (pressure.hpp), which is the definition, relative to the field's root mean square. The same bytes for any
// number of threads and any processor.
//
// It is the twin of FieldPass (field_pass.hpp). A layout made by hand of transducers of radius 0 and level 1, with
// Directivity::omni, is a sum of point sources e^{ikr} / r.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/incident_kernels.hpp"
#include "array/directivity.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"

namespace palpa::acoustics {

/// s_t of one drive or of many, one after the other: entry [drive * transducers + transducer]. 1 is full amplitude.
using Strengths = std::vector<std::complex<double>>;
/// amplitude e^{i phase} of each transducer.
Strengths strengths_of(std::span<const array::TransducerDrive> drive);

/// Complex pressures in Pa, peak, and their slopes in Pa/m, entry [drive * points + point].
struct Waves {
  std::vector<std::complex<double>> pressures;
  std::vector<std::complex<double>> slopes;  ///< none where no normals are given
};

class Incident {
 public:
  /// Of this layout, as posed where the points are, which outlives it.
  Incident(const array::Layout& layout, const Air& air, array::Directivity directivity);

  /// Fills `waves` for these points, metres, and directions, unit vectors: one per point or none at all. Points are
  /// within 100 m. False, and nothing of use, if `give_up` became true meanwhile. It counts points as it goes
  /// (Activity).
  bool at(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const std::complex<double>> strengths,
          Waves& waves, const std::atomic<bool>* give_up = nullptr) const;

  /// The other way round, by reciprocity: what sources at the points send to each transducer, with its level. A row of
  /// `strengths` has a monopole per point, `slopes`, where not empty, adds one along each normal:
  ///
  ///   received[row * transducers + t] = level * sum over points of a_i G_t(x_i) + b_i n_i . grad G_t(x_i)
  bool received(std::span<const Vec3> points, std::span<const Vec3> normals,
                std::span<const std::complex<double>> strengths, std::span<const std::complex<double>> slopes,
                std::vector<std::complex<double>>& received, const std::atomic<bool>* give_up = nullptr) const;

 private:
  const array::Layout& layout_;
  TransferSetting setting_;
};

}  // namespace palpa::acoustics
