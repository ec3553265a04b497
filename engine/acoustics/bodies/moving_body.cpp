#include "acoustics/bodies/moving_body.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "acoustics/bodies/few_places.hpp"
#include "acoustics/field/incident.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

/// The error of the sound at the few places (few_places.hpp).
constexpr double tolerance = 2e-3;
/// Places whose equations are solved at once.
constexpr std::size_t together = 64;

}  // namespace

MovingBody::MovingBody(std::shared_ptr<const RigidBody> body, const Air& air, array::Directivity directivity,
                       const std::atomic<bool>* give_up)
    : body_(std::move(body)), air_(without_absorption(air)), directivity_(directivity), places_(body_->patches()) {
  const std::vector<FewPlaces> clusters = few_places(*body_, tolerance, give_up);
  for (const FewPlaces& cluster : clusters) {
    for (const std::uint32_t vertex : cluster.chosen) {
      heard_at_.push_back(body_->mesh().positions[vertex]);
      heard_along_.push_back(body_->vertex_normals()[vertex]);
    }
  }
  const std::size_t few = heard_at_.size(), size = body_->mesh().positions.size();
  responses_.resize(size * few);
  std::vector<std::complex<float>> columns;
  std::size_t place = 0;
  for (const FewPlaces& cluster : clusters) {
    for (std::size_t first = 0; first < cluster.chosen.size(); first += together) {
      stop_if(give_up);
      const std::size_t count = std::min(together, cluster.chosen.size() - first);
      columns.assign(count * size, 0);
      for (std::size_t s = 0; s < count; ++s) {
        for (std::size_t v = 0; v < cluster.vertices.size(); ++v)
          columns[s * size + cluster.vertices[v]] = cluster.shares[(first + s) * cluster.vertices.size() + v];
      }
      body_->respond(columns, give_up);
      for (std::size_t v = 0; v < size; ++v) {
        for (std::size_t s = 0; s < count; ++s)
          responses_[v * few + place + s] = columns[s * size + v];
      }
      place += count;
    }
  }
}

std::vector<MovingBody::Heard> MovingBody::hear(std::span<const Vec3> foci, const array::Layout& layout,
                                                const std::atomic<bool>* give_up) const {
  const std::size_t few = heard_at_.size(), transducers = layout.transducers.size();
  std::vector<Heard> heard;
  std::vector<std::complex<double>> strengths(foci.size() * few);
  for (std::size_t j = 0; j < foci.size(); ++j) {
    const BodyPlace place = places_.of(foci[j]);
    heard.push_back({body_->patches().patches[place.face].at(place.u, place.v), place.distance_m, {}});
    const RigidBody::Row row = body_->row_on_skin(place.face, place.u, place.v);
    const auto sums = std::span(strengths).subspan(j * few, few);
    for (std::size_t v = 0; v < row.size(); ++v) {
      if (row[v] == std::complex<float>(0)) continue;
      const std::complex<double> factor(row[v]);
      for (std::size_t s = 0; s < few; ++s)
        sums[s] += factor * std::complex<double>(responses_[v * few + s]);
    }
  }
  std::vector<std::complex<double>> received;
  const Incident incident(layout, air_, directivity_);
  incident.received(heard_at_, heard_along_, strengths, body_->slope_part(), received, give_up);
  stop_if(give_up);
  for (std::size_t i = 0; i < heard.size(); ++i)
    heard[i].sound.assign(received.begin() + static_cast<std::ptrdiff_t>(i * transducers),
                          received.begin() + static_cast<std::ptrdiff_t>((i + 1) * transducers));
  return heard;
}

}  // namespace palpa::acoustics
