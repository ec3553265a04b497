// The sound of drives at many points at once, in free air: the pressure and, on request, its slope.
//
//   p(x) = level * sum over transducers of s_t G_t(x),   G_t(x) = D(angle) e^{(ik - alpha) r} / max(r, radius)
//
// The slope is n . grad p, including that of directivity and absorption. Drives at the same points share G, so that ten
// cost little more than one. Uses all cores. Phases are in double precision, all else in single. The result is within
// 1e-5 of pressure_at (pressure.hpp), the reference, relative to the field's root mean square. The same bytes for any
// number of threads and any processor.
//
// This is the twin of FieldPass (field_pass.hpp). A hand-made layout of transducers of radius 0 and level 1, with
// Directivity::omni, is a sum of point sources e^{ikr} / r.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/incident_kernels.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::acoustics {

/// s_t of one or several drives, one after the other: entry [drive * transducers + transducer]. 1 is full amplitude.
using Strengths = std::vector<std::complex<double>>;
/// amplitude e^{i phase} of each transducer.
Strengths strengths_of(std::span<const array::TransducerDrive> drive);

/// Complex pressures in Pa, peak, and their slopes in Pa/m, entry [drive * points + point].
struct Waves {
  std::vector<std::complex<double>> pressures;
  std::vector<std::complex<double>> slopes;  ///< empty if no normals are given
};

class Incident {
 public:
  /// The layout is posed in the frame of the points and must outlive it.
  Incident(const array::Layout& layout, const Air& air, array::Directivity directivity);

  /// Fills `waves` for these points (metres) and directions (unit vectors, one per point or none at all). Points are
  /// within 100 m. Returns false, with a meaningless result, if `give_up` became true meanwhile. Reports its progress
  /// in points (Activity).
  bool at(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const std::complex<double>> strengths,
          Waves& waves, const std::atomic<bool>* give_up = nullptr) const;

  /// The reverse, by reciprocity: the sound that sources at the points send to each transducer, with its level. A row
  /// of `strengths` has one a per point. Each source is a monopole and, if normals are given, `slope` times a dipole:
  ///
  ///   received[row * transducers + t] = level * sum over points of a_i (G_t(x_i) + slope n_i . grad G_t(x_i))
  bool received(std::span<const Vec3> points, std::span<const Vec3> normals,
                std::span<const std::complex<double>> strengths, std::complex<double> slope,
                std::vector<std::complex<double>>& received, const std::atomic<bool>* give_up = nullptr) const;

  const array::Layout& layout() const { return layout_; }

 private:
  const array::Layout& layout_;
  TransferSetting setting_;
};

}  // namespace palpa::acoustics
