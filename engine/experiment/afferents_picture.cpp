#include "experiment/afferents_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "drawing/arrange.hpp"
#include "drawing/line_picture.hpp"
#include "setup/files/finger_picture.hpp"

namespace palpa::experiment {
namespace {

/// The site whose skin each face of the body is; -1 beyond the sites' faces.
std::vector<std::int64_t> sites_of_faces(const AfferentsResult& result) {
  std::vector<std::int64_t> sites(result.body.triangles.size(), -1);
  for (const std::uint32_t face : result.sites.faces) {
    const Vec3 centroid = acoustics::face_centroid(result.body, face);
    sites[face] = static_cast<std::int64_t>(observer::nearest_site(result.sites, centroid));
  }
  return sites;
}

drawing::Pixels rates_picture(const AfferentsResult& result, const setup::SeenFromBelow& seen,
                              const std::vector<std::int64_t>& site_of_face, std::size_t kind) {
  std::vector<double> values(setup::below_side * setup::below_side, std::numeric_limits<double>::quiet_NaN());
  double most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (seen.face[i] < 0) continue;
    const std::int64_t site = site_of_face[static_cast<std::size_t>(seen.face[i])];
    if (site < 0) continue;
    values[i] = result.rates_hz[static_cast<std::size_t>(site)][kind];
    most = std::max(most, values[i]);
  }
  return setup::draw_from_below(
      values, result.class_name(kind) + ": rates",
      {fmt::format("{:.0f} afferents, {:.0f} % of them fire", result.afferents[kind], 100 * result.active[kind])},
      most > 0 ? most : 1, "spikes per second");
}

drawing::Pixels times_picture(const AfferentsResult& result, std::size_t kind) {
  // A line needs two values.
  std::vector<double> values;
  for (const ByClass& spikes : result.spikes)
    values.push_back(spikes[kind] / result.bin_s);
  if (values.size() == 1) values.push_back(values.front());
  drawing::LinePicture picture;
  picture.values = values;
  picture.length_mm = static_cast<double>(result.spikes.size()) * result.bin_s * 1e3;
  picture.along = "time";
  picture.along_unit = "ms";
  picture.title = result.class_name(kind) + ": all afferents";
  picture.notes = {fmt::format("in bins of {:g} ms", result.bin_s * 1e3)};
  picture.most = std::max(1.0, *std::ranges::max_element(values));
  picture.unit = "spikes per second";
  return drawing::draw(picture);
}

}  // namespace

drawing::Pixels afferents_picture(const AfferentsResult& result) {
  const setup::SeenFromBelow seen(result.body, Vec3(0));
  const std::vector<std::int64_t> sites = sites_of_faces(result);
  std::vector<drawing::Pixels> pictures;
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind)
    pictures.push_back(drawing::halved(rates_picture(result, seen, sites, kind)));
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind)
    pictures.push_back(drawing::halved(times_picture(result, kind)));
  return drawing::side_by_side(pictures, observer::afferent_classes);
}

}  // namespace palpa::experiment
