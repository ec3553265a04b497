#include "cli/field_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <string_view>
#include <vector>

#include "array/field/directivity.hpp"
#include "base/system/memory.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "drawing/field_picture.hpp"
#include "drawing/line_picture.hpp"
#include "drawing/png.hpp"
#include "setup/options/places.hpp"

namespace palpa::cli {
namespace {

/// "3.2" for 3.2 mm, also for values that differ from it by nanometres.
std::string in_mm(double metres) {
  const double mm = std::round(metres * 1e9) / 1e6;
  return fmt::format("{:g}", mm == 0 ? 0 : mm);
}

std::string place_text(const Vec3& at) {
  return fmt::format("({}, {}, {})", in_mm(at.x), in_mm(at.y), in_mm(at.z));
}

std::string title_of(const setup::FieldResult& field, const setup::FieldTask& task) {
  const std::string name = printable(field.layout, 40);
  if (field.foci.empty()) return fmt::format("{}: {}", name, printable(shortened(task.drive_file, 40)));
  if (field.foci.size() > 1) return fmt::format("{}: {} foci", name, field.foci.size());
  return fmt::format("{}: focus at {} mm", name, place_text(field.foci[0].position));
}

/// Notes, top and unit of a picture's values. Above the pressure up to which linear acoustics holds, values are shown
/// relative to the largest.
template <typename Picture>
void set_values(Picture& picture, const setup::FieldResult& field, const std::string& place,
                const setup::FieldTask& task, double most_pa) {
  picture.title = "Sound pressure, " + title_of(field, task);
  picture.notes = {fmt::format(
      "{}; {}, {:g} kHz, {:.1f} m/s, {:.3f} Np/m", place, word_of(array::directivity_words, task.drive.directivity),
      field.air.medium.frequency / 1e3, field.air.medium.sound_speed, field.air.absorption_np_m)};
  picture.most = most_pa;
  picture.unit = "Pa, peak";
  if (!field.beyond_linear()) return;
  picture.notes.push_back(
      fmt::format("Beyond linear acoustics: the linear sum reaches {:.1f} kPa", field.peak_pa() / 1e3));
  picture.scale = 1 / field.peak_pa();
  picture.most = most_pa / field.peak_pa();
  picture.unit = "of the largest";
}

std::vector<double> sizes_of(const setup::FieldResult& field) {
  std::vector<double> sizes;
  reserve_large(sizes, field.pressures.size());
  sizes.resize(field.pressures.size());
  std::ranges::transform(field.pressures, sizes.begin(), [](const std::complex<double>& p) { return std::abs(p); });
  return sizes;
}

void draw_plane(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  const setup::Grid& grid = *field.places.grid;
  const std::vector<double> sizes = sizes_of(field);
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
  set_values(picture, field, fmt::format("{} = {} mm", static_cast<char>('x' + depth), in_mm(grid.centre[depth])), task,
             field.peak_pa());
  drawing::write_png(file, drawing::draw(picture));
}

void draw_line(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  const Vec3 &from = field.places.points.front(), &to = field.places.points.back();
  const std::vector<double> sizes = sizes_of(field);
  std::vector<double> low, high;
  double most = field.peak_pa();
  if (field.spread) {
    for (const setup::Percentiles& range : field.spread->amplitudes) {
      low.push_back(range.p05);
      high.push_back(range.p95);
      most = std::max(most, range.p95);
    }
  }
  drawing::LinePicture picture;
  picture.values = sizes;
  picture.low = low;
  picture.high = high;
  picture.length_mm = glm::distance(from, to) * 1e3;
  picture.along = fmt::format("distance from {}", place_text(from));
  // A little room above the curve.
  set_values(picture, field, fmt::format("from {} to {} mm", place_text(from), place_text(to)), task, 1.04 * most);
  if (field.spread) {
    const setup::Draws& draws = field.spread->draws;
    picture.notes.push_back(fmt::format("Band: 90 % of {} random arrays, --spread {}", draws.count, task.spread.text));
  }
  drawing::write_png(file, drawing::draw(picture));
}

}  // namespace

void draw_field(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  if (field.places.grid) return draw_plane(file, field, task);
  draw_line(file, field, task);
}

}  // namespace palpa::cli
