// The computation of `palpa field`: the sound of an array's drive on a plane, on a line or at points, in free air.
// Lengths are in metres, in the layout's own frame. Pressures are in Pa, complex and peak, with the time factor e^-iwt.
// The formula is in acoustics/field/incident.hpp.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "array/drive_options.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "base/files/json_rows.hpp"
#include "gpu/device.hpp"
#include "setup/options/options.hpp"
#include "setup/options/places.hpp"
#include "setup/options/spread.hpp"

namespace palpa::setup {

/// The sound and the places, as names and files, as on the command line.
struct FieldTask {
  std::string layout;             ///< a built-in name or a file
  std::string drive_file;         ///< a drive of that layout, in the format of drive_csv (drive_file.hpp),
  std::vector<std::string> foci;  ///< or foci for which a drive is made: texts for schedule_of (foci.hpp)
  PlaceOptions place;
  FocusingOptions drive;  ///< with a drive's file, only directivity and medium are used
  AirOptions air;
  SpreadOptions spread;
};
/// Throws bad_usage, naming the command's options, if some are missing or exclude each other. `picture`: the field is
/// to be drawn, which requires a plane or a line.
void check(const FieldTask& task, bool picture = false);

/// What random arrays make of a field.
struct FieldSpread {
  Draws draws;
  Percentiles peak_pa;
  std::array<Percentiles, 3> peak_m;    ///< x, y, z of the loudest point
  std::vector<Percentiles> amplitudes;  ///< |p| in Pa, one per point
};

struct FieldResult {
  Places places;
  std::vector<std::complex<double>> pressures;  ///< one per point
  std::size_t loudest = 0;                      ///< the first point with the largest |p|
  acoustics::Air air;
  std::string layout;                   ///< name of the layout
  std::vector<array::SlotFocus> foci;   ///< for which the drive was made; empty if the drive was given
  std::optional<array::DrivenBy> by{};  ///< how it was made
  std::optional<FieldSpread> spread;    ///< if requested
  /// Times of the sum and of the complete task. A caller may add the time for its use of the result.
  double sum_ms = 0, total_ms = 0;

  double peak_pa() const { return std::abs(pressures[loudest]); }
  /// Whether a point has more pressure than linear acoustics holds for (array::linear_pressure_pa).
  bool beyond_linear() const;
};
/// The members of that result's JSON, in their order. The result's own to_json writes them.
const JsonRows<FieldResult>& field_rows();
/// The output of `palpa field --json` (docs/acoustics.md).
std::string to_json(const FieldResult& result);

/// The field of that drive, one entry per transducer. `places` come from plane_places, line_places or point_places.
/// Computed on `device`, or on the processor if that is null; they agree within 1e-4 of the field's root mean square
/// (acoustics/field/field_pass.hpp). Throws bad_usage for a drive with another number of transducers and for places
/// without a point.
FieldResult sum_field(const array::Layout& layout, std::span<const array::TransducerDrive> drive, Places places,
                      const acoustics::Air& air, array::Directivity directivity = array::Directivity::t4010a1,
                      const gpu::Device* device = nullptr);

/// The field of this drive, made for `task`, at these places for `count` arrays as built (array/layouts/as_built.hpp).
/// Needs four bytes per point and draw; throws failure if that is more than the memory that is free.
FieldSpread spread_of_field(const FieldTask& task, const array::Layout& layout, const array::Drive& drive,
                            std::span<const Vec3> points, const Draws& draws, const gpu::Device* device = nullptr);

/// The same from files. Only the backend, the choice of device and the seed in `common` are used. `all_read` is called
/// after all input is read and before the long computation begins. Throws as check, array::load_layout, load_places,
/// load_drive and schedule_of do. Warns of unusual values.
FieldResult sum_field(const FieldTask& task, const CommonOptions& common, const std::function<void()>& all_read = {});

}  // namespace palpa::setup
