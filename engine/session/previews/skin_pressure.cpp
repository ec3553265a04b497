#include "session/previews/skin_pressure.hpp"

#include <algorithm>
#include <chrono>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/system/parallel.hpp"
#include "session/loop/output.hpp"

namespace palpa::session {
namespace {

/// The time average of the squared gain of the modulation and the newest values of the course, sampled at slots.
double mean_square(const Plan& plan) {
  const Cycle& cycle = plan.cycle;
  if (cycle.modulation_hz == 0 && !plan.course.changes()) return 1;
  const array::Course course{.from = plan.course.to, .to = plan.course.to, .texture = plan.course.texture};
  const double slot_s = plan.schedule.slot_s;
  constexpr std::uint64_t slots = 4000;  // whole periods of every usual modulation, six seconds
  double sum = 0;
  for (std::uint64_t slot = 0; slot < slots; ++slot) {
    const double midpoint_s = (static_cast<double>(slot) + 0.5) * slot_s;
    const double gain = array::modulation_gain(cycle.modulation, cycle.modulation_hz, midpoint_s) *
                        array::modulate(course, slot, slot_s);
    sum += gain * gain;
  }
  return sum / static_cast<double>(slots);
}

/// Number of sounds solved together; their incident waves are all in memory at the same time.
constexpr std::size_t together = 16;

}  // namespace

Sounds sounds_of(const Plan& plan, const array::Layout& layout, const array::DriveOptions& options) {
  const std::uint64_t slots = plan.cycle.slots_to_look_at();
  const double modulated = plan.cycle.is_listed() ? mean_square(plan) : 1;
  const std::uint64_t first = array::first_changing_slot(plan.schedule);
  const double weight = modulated / static_cast<double>(slots);
  const OutputSetting output{.layout = layout, .drive = options, .slot_s = plan.schedule.slot_s, .safety = {}};
  SlotScratch scratch;
  Sounds sounds;
  for (std::uint64_t slot = 0; slot < slots; ++slot) {
    const auto drive = plan.cycle.is_listed() ? plan.drive(slot, layout.transducers.size())
                                              : drive_of_slot(plan, first + slot, plan.captured_s, output, scratch);
    const acoustics::Strengths strengths = acoustics::strengths_of(drive);
    sounds.strengths.insert(sounds.strengths.end(), strengths.begin(), strengths.end());
    sounds.weights.push_back(weight);
  }
  return sounds;
}

namespace {

/// Adds to the mean the forces of these unknowns, one wave after the other.
void add_far(std::span<const std::complex<double>> strengths, std::span<const double> weights,
             std::span<const std::complex<float>> unknowns, const acoustics::RigidBody& body, const acoustics::Air& air,
             FarSound& far) {
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t vertices = unknowns.size() / weights.size(), transducers = strengths.size() / weights.size();
  acoustics::Strengths lossless;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Vec3 loudest = acoustics::loudest_vertex(body, unknowns.subspan(i * vertices, vertices));
    const acoustics::Strengths one = acoustics::without_absorption(strengths.subspan(i * transducers, transducers),
                                                                   far.lossless.layout(), air, loudest);
    lossless.insert(lossless.end(), one.begin(), one.end());
  }
  acoustics::Waves waves;
  far.lossless.at(far.force.points(), far.force.normals(), lossless, waves);
  const std::vector<Vec3> forces = far.force.forces(waves, unknowns, air);
  for (std::size_t i = 0; i < forces.size(); ++i)
    far.mean += weights[i] * forces[i];
  far.took_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

acoustics::SkinPressure mean_pressure(const Sounds& sounds, const acoustics::Incident& incident,
                                      const acoustics::Air& air, const acoustics::RigidBody& body,
                                      const std::atomic<bool>* give_up) {
  return mean_pressure(sounds, incident, air, body, nullptr, give_up);
}

acoustics::SkinPressure mean_pressure(const Sounds& sounds, const acoustics::Incident& incident,
                                      const acoustics::Air& air, const acoustics::RigidBody& body, FarSound* far,
                                      const std::atomic<bool>* give_up) {
  acoustics::SkinPressure pressure;
  const std::size_t vertices = body.mesh().positions.size();
  const std::size_t transducers = sounds.strengths.size() / sounds.weights.size();
  acoustics::Waves waves;
  for (std::size_t first = 0; first < sounds.weights.size(); first += together) {
    const std::size_t count = std::min(together, sounds.weights.size() - first);
    incident.at(body.points(), body.normals(),
                std::span(sounds.strengths).subspan(first * transducers, count * transducers), waves, give_up);
    stop_if(give_up);
    const std::vector<std::complex<float>> unknowns = body.solve(waves, give_up);
    for (std::size_t i = 0; i < count; ++i) {
      acoustics::add_pressure(body, std::span(unknowns).subspan(i * vertices, vertices), air, sounds.weights[first + i],
                              pressure);
    }
    if (far) {
      add_far(std::span(sounds.strengths).subspan(first * transducers, count * transducers),
              std::span(sounds.weights).subspan(first, count), unknowns, body, air, *far);
    }
  }
  return pressure;
}

double bare_elongation(const Sounds& sounds, const acoustics::Incident& incident, const Vec3& centre) {
  constexpr int steps = 30;
  constexpr double step_m = 0.5e-3;
  std::vector<Vec3> points;
  for (int i = -steps; i <= steps; ++i) {
    for (int j = -steps; j <= steps; ++j)
      points.push_back(centre + step_m * Vec3(i, 0, j));
  }
  acoustics::Waves waves;
  incident.at(points, {}, sounds.strengths, waves);
  std::vector<double> mean(points.size());
  for (std::size_t sound = 0; sound < sounds.weights.size(); ++sound) {
    for (std::size_t i = 0; i < points.size(); ++i)
      mean[i] += sounds.weights[sound] * std::norm(waves.pressures[sound * points.size() + i]);
  }
  const double half = *std::ranges::max_element(mean) / 2;
  std::vector<Vec3> above;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (mean[i] > half) above.push_back(points[i]);
  }
  return acoustics::elongation_of(above, std::vector<double>(above.size(), step_m * step_m));
}

}  // namespace palpa::session
