#include "cli/field_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string_view>
#include <vector>

#include "array/directivity.hpp"
#include "base/memory.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "drawing/field_picture.hpp"
#include "drawing/png.hpp"
#include "setup/places.hpp"

namespace palpa::cli {
namespace {

/// "3.2" for 3.2 mm, also for values that differ from it by nanometres.
std::string in_mm(double metres) {
  const double mm = std::round(metres * 1e9) / 1e6;
  return fmt::format("{:g}", mm == 0 ? 0 : mm);
}

std::string title_of(const setup::FieldResult& field, const setup::FieldTask& task) {
  const std::string name = printable(field.layout, 40);
  if (field.foci.empty()) return fmt::format("{}: {}", name, printable(shortened(task.drive_file, 40)));
  if (field.foci.size() > 1) return fmt::format("{}: {} foci", name, field.foci.size());
  const Vec3& at = field.foci[0].position;
  return fmt::format("{}: focus at ({}, {}, {}) mm", name, in_mm(at.x), in_mm(at.y), in_mm(at.z));
}

}  // namespace

void draw_field(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  const setup::Grid& grid = *field.places.grid;
  std::vector<double> sizes;
  reserve_large(sizes, field.pressures.size());
  sizes.resize(field.pressures.size());
  std::ranges::transform(field.pressures, sizes.begin(), [](const std::complex<double>& p) { return std::abs(p); });
  const std::string_view letters = word_of(setup::plane_words, grid.plane);
  const auto axis = [](char letter) { return letter - 'x'; };
  const int right = axis(letters[0]), up = axis(letters[1]), depth = 3 - right - up;

  drawing::FieldPicture picture;
  picture.values = sizes;
  picture.columns = grid.columns;
  picture.rows = grid.rows;
  const Vec2 centre(grid.centre[right], grid.centre[up]);
  picture.low_mm = (centre - grid.size_m * 0.5) * 1e3;
  picture.high_mm = (centre + grid.size_m * 0.5) * 1e3;
  picture.right = letters[0];
  picture.up = letters[1];
  picture.title = "Sound pressure, " + title_of(field, task);
  picture.notes = {fmt::format("{} = {} mm; {}, {:g} kHz, {:.1f} m/s, {:.3f} Np/m", static_cast<char>('x' + depth),
                               in_mm(grid.centre[depth]), word_of(array::directivity_words, task.drive.directivity),
                               field.air.medium.frequency / 1e3, field.air.medium.sound_speed,
                               field.air.absorption_np_m)};
  if (field.beyond_linear()) {
    picture.notes.push_back(
        fmt::format("Beyond linear acoustics: the linear sum reaches {:.1f} kPa", field.peak_pa() / 1e3));
    picture.scale = 1 / field.peak_pa();
    picture.most = 1;
    picture.unit = "of the largest";
  } else {
    picture.most = field.peak_pa();
    picture.unit = "Pa, peak";
  }
  drawing::write_png(file, drawing::draw(picture));
}

}  // namespace palpa::cli
