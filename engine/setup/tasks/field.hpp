// What `palpa field` computes: the sound of an array's drive on a plane, on a line or at points, in free air. Lengths
// in metres, in the layout's own frame; pressures in Pa, complex and peak, time factor e^-iwt. The formula is in
// acoustics/field/incident.hpp.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "array/directivity.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "gpu/device.hpp"
#include "setup/options.hpp"
#include "setup/places.hpp"

namespace palpa::setup {

/// What sounds and where it is asked for, by names and files, as the command line gives it.
struct FieldTask {
  std::string layout;             ///< a built-in name or a file
  std::string drive_file;         ///< a drive of that layout, as drive_csv has it (drive_file.hpp),
  std::vector<std::string> foci;  ///< or foci that one is made for: texts of schedule_of (foci.hpp)
  PlaceOptions place;
  DriveOptionsGroup drive;  ///< with a drive's file only directivity and medium
  AirOptions air;
};
/// Throws bad_usage, which names the command's options, where some are missing or exclude each other. `picture`: the
/// field is to be drawn, which takes a plane.
void check(const FieldTask& task, bool picture = false);

struct FieldResult {
  Places places;
  std::vector<std::complex<double>> pressures;  ///< one per point
  std::size_t loudest = 0;                      ///< the first point with the largest |p|
  acoustics::Air air;
  std::string layout;                  ///< its name
  std::vector<array::SlotFocus> foci;  ///< that the drive was made for; none where the drive was given
  /// How long the sum took, and all of it. What somebody does with the result may be added.
  double sum_ms = 0, total_ms = 0;

  double peak_pa() const { return std::abs(pressures[loudest]); }
  /// Some point has more pressure than linear acoustics holds for (array::linear_pressure_pa).
  bool beyond_linear() const;
};
/// What `palpa field --json` writes (docs/files.md).
std::string to_json(const FieldResult& result);

/// The field of that drive, one entry per transducer. `places` as plane_places, line_places and point_places make them.
/// On `device`, and where that is null on the processor: they agree within 1e-4 of the field's root mean square
/// (acoustics/field/field_pass.hpp). Throws bad_usage for a drive of another number of transducers and for places
/// without a point.
FieldResult sum_field(const array::Layout& layout, std::span<const array::TransducerDrive> drive, Places places,
                      const acoustics::Air& air, array::Directivity directivity = array::Directivity::t4010a1,
                      const gpu::Device* device = nullptr);

/// The same of files. Of `common` the backend and what chooses a device count. `all_read` is called once all input is
/// read and the long work begins. Throws as check, array::load_layout, load_places, load_drive and schedule_of do, and
/// warns of what is unusual.
FieldResult sum_field(const FieldTask& task, const CommonOptions& common, const std::function<void()>& all_read = {});

}  // namespace palpa::setup
