#include "setup/sessions/study_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/sha256.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/gltf/gltf.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"
#include "study/plan/plan_file.hpp"

namespace palpa::setup {
namespace {

/// The chunks of a WAV file: whether it has a format and samples.
void check_wav(const std::string& file) {
  constexpr std::uint64_t most_bytes = 256u << 20;
  const std::string bytes = read_file(file, most_bytes);
  bool format = false, samples = false;
  if (bytes.starts_with("RIFF") && bytes.size() >= 12 && bytes.compare(8, 4, "WAVE") == 0) {
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
      std::uint32_t size = 0;
      for (std::size_t i = 0; i < 4; ++i)
        size |= std::uint32_t{static_cast<unsigned char>(bytes[at + 4 + i])} << (8 * i);
      format = format || bytes.compare(at, 4, "fmt ") == 0;
      samples = samples || (bytes.compare(at, 4, "data") == 0 && size > 0);
      at += 8 + std::size_t{size} + size % 2;
    }
  }
  if (!format || !samples)
    throw bad_input(file, "is no WAV file with a sound: masking of [run] is white, off, or a WAV file");
}

/// Whether the text of a model names the property, or has letters as codes, which may name it.
bool may_ask_pressure(const std::string& model) {
  constexpr std::string_view words[]{"palpa_pressure_pa", "\\u00"};
  constexpr std::uint64_t step = 1u << 20, overlap = 32;
  const InputFile file(model);
  std::string bytes(step + overlap, '\0');
  for (std::uint64_t at = 0; at < file.size(); at += step) {
    const std::size_t count = std::min(file.size() - at, step + overlap);
    file.read_at(at, {reinterpret_cast<unsigned char*>(bytes.data()), count});
    const std::string_view here(bytes.data(), count);
    if (std::ranges::any_of(words, [&](std::string_view word) { return here.find(word) != here.npos; })) return true;
  }
  return false;
}

}  // namespace

LeastSound least_sound(const geometry::Scene& scene, double deep_m) {
  LeastSound least;
  for (const geometry::SceneMesh& mesh : scene.meshes) {
    const geometry::Haptics& haptics = mesh.haptics;
    double gain = haptics.intensity.value_or(1);
    if (haptics.stiffness) {
      double force =
          std::max(geometry::force_at(*haptics.stiffness, 0), geometry::force_at(*haptics.stiffness, deep_m));
      for (const geometry::DepthForce& row : *haptics.stiffness)
        force = row.depth_m <= deep_m ? std::max(force, row.force) : force;
      gain *= std::sqrt(force);
    }
    if (gain < least.intensity) least.is_spring = haptics.stiffness.has_value();
    least.intensity = std::min(least.intensity, gain);
    if (haptics.pressure_pa) least.pressure_pa = std::min(*haptics.pressure_pa, least.pressure_pa.value_or(1e9));
  }
  return least;
}

void set_least(study::PlanShape& shape, const LeastSound& least) {
  shape.intensity = least.intensity;
  shape.is_spring = least.is_spring;
  shape.pressure_pa = least.pressure_pa;
}

std::vector<Box> try_files(study::StudyPlan& plan) {
  std::vector<Box> boxes;
  for (study::PlanShape& shape : plan.shapes) {
    const Activity work("reading " + shape.model);
    const geometry::Scene scene = geometry::load_gltf(shape.model);
    (void)solids_of(scene);
    set_least(shape, least_sound(scene, plan.run.deep_m));
    boxes.push_back(geometry::box_of(scene));
  }
  if (plan.run.masking != "white" && plan.run.masking != "off") check_wav(plan.run.masking);
  return boxes;
}

study::StudyPlan load_plan(const std::string& file) {
  if (file.empty())
    throw bad_usage("the plan is missing: give the TOML file of a study, such as assets/studies/paper.toml");
  study::StudyPlan plan = study::read_plan(file);
  for (study::PlanShape& shape : plan.shapes) {
    if (!study::is_own_model(shape.model)) continue;
    const std::string own = shape.model.substr(study::own_model_prefix.size());
    try {
      shape.model = find_asset(own);
    } catch (const Error& error) {
      throw bad_input(plan.file, fmt::format("the model of '{}' is {}, but {}", printable(shape.name),
                                             printable(shape.model), error.what()));
    }
  }
  study::refuse_missing_files(plan);
  for (const std::string& doubt : study::doubts_of(plan))
    log::warning(fmt::format("{}: {}", printable(plan.file), doubt));
  for (study::PlanShape& shape : plan.shapes)
    shape.model_sha256 = sha256_of_file(shape.model);
  for (study::PlanShape& shape : plan.shapes)
    shape.asks_pressure = may_ask_pressure(shape.model);
  return plan;
}

}  // namespace palpa::setup
