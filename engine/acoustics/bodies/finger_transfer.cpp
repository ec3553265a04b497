#include "acoustics/bodies/finger_transfer.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace palpa::acoustics {

using array::Columns;
using array::FocusSource;
using Complex = std::complex<double>;

namespace {

/// The number of foci that are solved at once: their sources on the skin are all in memory together.
constexpr std::size_t together = 16;

}  // namespace

FingerTransfer::FingerTransfer(const RigidBody& body, const array::Layout& layout, const Air& air,
                               array::Directivity directivity)
    : body_(body), layout_(layout), incident_(layout, air, directivity), places_(body.patches()) {}

const FingerTransfer::Aim* FingerTransfer::find(const Vec3& focus) const {
  const auto found = std::ranges::find(aims_, focus, &Aim::focus);
  return found == aims_.end() ? nullptr : &*found;
}

std::vector<Vec3> FingerTransfer::aim(std::span<const Vec3> foci) {
  std::vector<Aim> aims;
  aims.reserve(foci.size());
  std::vector<Aim*> fresh;
  for (const Vec3& focus : foci) {
    if (std::ranges::find(aims, focus, &Aim::focus) != aims.end()) continue;
    if (const Aim* known = find(focus)) {
      aims.push_back(*known);
    } else {
      fresh.push_back(&aims.emplace_back(Aim{focus, focus, {}}));
    }
  }
  for (std::size_t first = 0; first < fresh.size(); first += together)
    hear(std::span(fresh).subspan(first, std::min(together, fresh.size() - first)));
  aims_ = std::move(aims);
  std::vector<Vec3> places;
  places.reserve(foci.size());
  for (const Vec3& focus : foci)
    places.push_back(find(focus)->place);
  return places;
}

void FingerTransfer::hear(std::span<Aim* const> aims) const {
  std::vector<RigidBody::Row> rows;
  rows.reserve(aims.size());
  for (Aim* aim : aims) {
    const BodyPlace place = places_.of(aim->focus);
    if (place.where != BodyPlace::Where::air) {
      aim->place = body_.patches().patches[place.face].at(place.u, place.v);
      rows.push_back(body_.row_on_skin(place.face, place.u, place.v));
      continue;
    }
    // In the air, the direct sound of the transducers is added.
    constexpr Complex whole[]{1};
    rows.push_back(body_.row_in_air(aim->place));
    incident_.received(std::span(&aim->place, 1), {}, whole, 0, aim->sound);
  }
  const std::vector<Complex> sources = body_.sources_of(rows);
  std::vector<Complex> received;
  incident_.received(body_.points(), body_.normals(), sources, body_.slope_part(), received);
  const std::size_t transducers = layout_.transducers.size();
  for (std::size_t i = 0; i < aims.size(); ++i) {
    std::vector<Complex>& sound = aims[i]->sound;
    sound.resize(transducers);
    for (std::size_t t = 0; t < transducers; ++t)
      sound[t] += received[i * transducers + t];
  }
}

void FingerTransfer::fill(std::span<const FocusSource> foci, array::Weighting weighting, Columns& columns) const {
  fill(foci, weighting, 0, layout_.transducers.size(), columns);
}

void FingerTransfer::fill(std::span<const FocusSource> foci, array::Weighting weighting, std::size_t first,
                          std::size_t count, Columns& columns) const {
  columns.foci = foci.size();
  columns.transducers = count;
  for (std::vector<double>* values : {&columns.cosine, &columns.sine, &columns.loud, &columns.asked})
    values->assign(foci.size() * count, 0);
  for (std::size_t j = 0; j < foci.size(); ++j) {
    const FocusSource& focus = foci[j];
    const Aim* const aim = find(focus.position);
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t entry = n * foci.size() + j;
      const Complex sound = aim ? aim->sound[first + n] : 0;
      const double loud = std::abs(sound);
      columns.cosine[entry] = loud > 0 ? sound.real() / loud : 1;
      columns.sine[entry] = loud > 0 ? sound.imag() / loud : 0;
      columns.loud[entry] = loud / layout_.source_level_pa_m;
      if (!aim) continue;
      const bool even = weighting == array::Weighting::uniform || focus.farthest == 0;
      columns.asked[entry] =
          even ? 1 : glm::distance(layout_.transducers[first + n].position, focus.position) / focus.farthest;
    }
  }
}

}  // namespace palpa::acoustics
