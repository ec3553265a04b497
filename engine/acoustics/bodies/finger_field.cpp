#include "acoustics/bodies/finger_field.hpp"

#include <algorithm>
#include <complex>
#include <cstdint>

#include "acoustics/bodies/radiation.hpp"
#include "array/drive.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

/// The number of foci that are solved at once: their incident waves are all in memory together.
constexpr std::size_t together = 16;

}  // namespace

FingerField::FingerField(const RigidBody& body, const array::Layout& layout, const Air& air,
                         const array::DriveOptions& drive, FingerTransfer* transfer, std::optional<double> pressure_pa)
    : body_(body),
      layout_(layout),
      air_(air),
      drive_(drive),
      transfer_(transfer),
      pressure_pa_(pressure_pa),
      incident_(layout, air, drive.directivity),
      places_(body.patches()) {
  drive_.solver = array::Solver::naive;
  drive_.transfer = transfer;
}

double FingerField::step_m() const {
  return 1 / air_.medium.turns_per_metre() / 6;
}

Vec3 FingerField::skin_at(const Vec3& place) const {
  const BodyPlace skin = places_.of(place);
  return body_.patches().patches[skin.face].at(skin.u, skin.v);
}

bool FingerField::felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
                       const std::atomic<bool>* give_up) const {
  pressures.clear();
  std::vector<BodyPlace> places;
  std::vector<Vec3> foci;
  for (std::size_t i = 0; i < path.size(); ++i) {
    places.push_back(places_.of(path[i]));
    if (i % every == 0) foci.push_back(path[i]);
  }
  if (transfer_) transfer_->aim(foci);
  const std::size_t vertices = body_.mesh().positions.size();
  Strengths strengths;
  Waves waves;
  for (std::size_t first = 0; first < foci.size(); first += together) {
    const std::size_t count = std::min(together, foci.size() - first);
    strengths.clear();
    for (std::size_t i = first; i < first + count; ++i) {
      const array::SlotFocus focus{.position = foci[i], .pressure_pa = pressure_pa_};
      const Strengths one = strengths_of(array::drive_for(layout_, {&focus, 1}, drive_));
      strengths.insert(strengths.end(), one.begin(), one.end());
    }
    if (!incident_.at(body_.points(), body_.normals(), strengths, waves, give_up)) return false;
    std::vector<std::complex<float>> unknowns;
    try {
      unknowns = body_.solve(waves, give_up);
    } catch (const GivenUp&) {
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto wave = std::span(unknowns).subspan(i * vertices, vertices);
      for (const BodyPlace& place : places)
        pressures.push_back(radiation_of(body_.at_skin(wave, place.face, place.u, place.v), air_).langevin);
    }
  }
  return true;
}

}  // namespace palpa::acoustics
