#include "acoustics/bodies/tracked_finger.hpp"

#include <cstddef>
#include <utility>

#include "acoustics/field/incident.hpp"
#include "base/parallel.hpp"

namespace palpa::acoustics {

TrackedFinger::TrackedFinger(std::shared_ptr<const RigidBody> body, const Air& air, array::Directivity directivity)
    : body_(std::move(body)), air_(without_absorption(air)), directivity_(directivity), places_(body_->patches()) {}

std::vector<TrackedFinger::Heard> TrackedFinger::hear(std::span<const Vec3> foci, const array::Layout& layout,
                                                      const std::atomic<bool>* give_up) const {
  std::vector<Heard> heard;
  std::vector<RigidBody::Row> rows;
  for (const Vec3& focus : foci) {
    const BodyPlace place = places_.of(focus);
    heard.push_back({body_->patches().patches[place.face].at(place.u, place.v), place.distance_m, {}});
    rows.push_back(body_->row_on_skin(place.face, place.u, place.v));
  }
  const RigidBody::Sources sources = body_->vertex_sources_of(rows, give_up);
  std::vector<std::complex<double>> received;
  const Incident incident(layout, air_, directivity_);
  incident.received(body_->mesh().positions, body_->vertex_normals(), sources.strengths, sources.slopes, received,
                    give_up);
  stop_if(give_up);
  const std::size_t transducers = layout.transducers.size();
  for (std::size_t i = 0; i < heard.size(); ++i)
    heard[i].sound.assign(received.begin() + static_cast<std::ptrdiff_t>(i * transducers),
                          received.begin() + static_cast<std::ptrdiff_t>((i + 1) * transducers));
  return heard;
}

}  // namespace palpa::acoustics
