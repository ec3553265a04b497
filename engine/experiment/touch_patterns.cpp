#include "experiment/touch_patterns.hpp"

#include <algorithm>
#include <complex>
#include <cstdint>
#include <cstring>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/field/incident.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/sessions/touch_run.hpp"

namespace palpa::experiment {
namespace {

/// The finger's own frame in the world.
Transform pose_of(const ObservedFinger& finger, const TouchedScene& scene, const observer::FingerPlace& place,
                  std::vector<Vec3>& skin) {
  Transform T_world_finger =
      glm::rotate(glm::translate(Transform(1.0), Vec3(place.x_m, 0, place.z_m)), place.yaw_rad, Vec3(0, 1, 0));
  skin.clear();
  for (const Vec3& p : finger.skin())
    skin.push_back(transform_point(T_world_finger, p));
  const double dy = setup::lowering(scene.solids, skin, scene.depth_m);
  for (Vec3& p : skin)
    p.y += dy;
  T_world_finger[3].y += dy;
  return T_world_finger;
}

/// The method's plan for this skin.
session::Plan plan_of(const ObservedMethod& observed, const TouchedScene& scene, const setup::TouchInput& skin) {
  const study::PlanMethod& m = observed.method;
  setup::TouchOptions touch;
  touch.parameters.delta_m = m.delta_m;
  touch.parameters.foci = m.foci;
  touch.stride = m.stride;
  touch.dwell_s = m.dwell_s;
  touch.method.method = m.method;
  touch.modulation_hz = m.modulation_hz;
  setup::FocusingOptions focusing;
  focusing.weighting = m.amplitude;
  if (m.solver) focusing.solver = setup::choice_of(*m.solver);
  focusing.constraint = m.constraint;
  setup::ComputeOptions compute;
  compute.backend = setup::Backend::cpu;
  setup::StepTimes times;
  const setup::OneTouch one =
      setup::touch_once(compute, touch, {}, scene.file, scene.solids, skin,
                        {.layout = *observed.layout,
                         .drive = setup::drive_options(focusing, *observed.layout, setup::solving_of(m.method))},
                        times);
  if (one.touch.finger_count == 0) return {};
  const session::Plan& plan = one.session.plan();
  if (plan.cycle.plays == session::Plays::slot_by_slot)
    throw bad_input(scene.file,
                    "the schedule of '" + m.name + "' repeats too late for the observer; choose another dwell");
  return plan;
}

}  // namespace

std::vector<TouchPattern> patterns_of(ObservedFinger& finger, const Transform& T_world_finger,
                                      const array::Layout& layout, std::span<const session::Plan> plans,
                                      array::Directivity directivity, const std::atomic<bool>* give_up) {
  const array::Layout around = array::transformed(layout, glm::inverse(T_world_finger));
  acoustics::check_clear_of(finger.name(), finger.mesh(), around);
  std::vector<TouchPattern> patterns(plans.size());
  const acoustics::RigidBody& body = finger.body();
  const std::size_t vertices = body.mesh().positions.size(), transducers = layout.transducers.size();
  // Each drive once, with the places of its maps.
  std::vector<array::TransducerDrive> drives;
  std::vector<std::pair<std::size_t, std::uint32_t>> users;  // plan and map
  for (std::size_t p = 0; p < plans.size(); ++p) {
    const session::Plan& plan = plans[p];
    observer::PressurePattern& pattern = patterns[p].pattern;
    pattern.slot_s = plan.schedule.slot_s;
    pattern.modulation_hz = plan.cycle.modulation_hz;
    pattern.modulation = plan.cycle.modulation;
    const std::size_t own = drives.size() / transducers;
    for (std::uint32_t slot = 0; slot < plan.cycle.length; ++slot) {
      const auto drive = plan.drive(slot, transducers);
      std::size_t same = own;
      while (same < drives.size() / transducers &&
             std::memcmp(&drives[same * transducers], drive.data(), drive.size_bytes()) != 0)
        ++same;
      if (same == drives.size() / transducers) {
        drives.insert(drives.end(), drive.begin(), drive.end());
        users.emplace_back(p, static_cast<std::uint32_t>(same - own));
      }
      pattern.slots.push_back(static_cast<std::uint32_t>(same - own));
    }
    pattern.maps.resize(drives.size() / transducers - own);
  }
  const acoustics::Incident incident(around, finger.air(), directivity);
  constexpr std::size_t together = 32;
  acoustics::Waves waves;
  for (std::size_t begin = 0; begin < users.size(); begin += together) {
    const std::size_t count = std::min(together, users.size() - begin);
    const acoustics::Strengths strengths =
        acoustics::strengths_of(std::span(drives).subspan(begin * transducers, count * transducers));
    incident.at(body.points(), body.normals(), strengths, waves, give_up);
    stop_if(give_up);
    const std::vector<std::complex<float>> unknowns = body.solve(waves, give_up);
    for (std::size_t i = 0; i < count; ++i) {
      acoustics::SkinPressure pressure;
      acoustics::add_pressure(body, std::span(unknowns).subspan(i * vertices, vertices), finger.air(), 1, pressure);
      const auto [plan, map] = users[begin + i];
      for (const std::uint32_t face : finger.sites().faces)
        patterns[plan].pattern.maps[map].push_back(static_cast<float>(pressure.langevin[face]));
      patterns[plan].crest_n = std::max(patterns[plan].crest_n, glm::length(pressure.langevin_load.force));
    }
  }
  return patterns;
}

std::vector<TouchPattern> touch_patterns(ObservedFinger& finger, const TouchedScene& scene,
                                         const observer::FingerPlace& place, std::span<const ObservedMethod> methods) {
  std::vector<Vec3> world;
  const Transform T_world_finger = pose_of(finger, scene, place, world);
  const setup::TouchInput skin = setup::skin_points(finger.name(), world);
  std::vector<TouchPattern> patterns(methods.size());
  std::vector<bool> done(methods.size(), false);
  for (std::size_t first = 0; first < methods.size(); ++first) {
    if (done[first]) continue;
    std::vector<std::size_t> own;  // methods with the same layout
    std::vector<session::Plan> plans;
    for (std::size_t m = first; m < methods.size(); ++m) {
      if (methods[m].layout != methods[first].layout) continue;
      done[m] = true;
      own.push_back(m);
      plans.push_back(plan_of(methods[m], scene, skin));
    }
    std::vector<TouchPattern> found =
        patterns_of(finger, T_world_finger, *methods[first].layout, plans, array::Directivity::t4010a1);
    for (std::size_t i = 0; i < own.size(); ++i)
      patterns[own[i]] = std::move(found[i]);
  }
  return patterns;
}

}  // namespace palpa::experiment
