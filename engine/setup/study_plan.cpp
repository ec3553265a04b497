#include "setup/study_plan.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/sha256.hpp"
#include "base/text.hpp"
#include "setup/assets.hpp"
#include "setup/load.hpp"
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

}  // namespace

void try_files(const study::StudyPlan& plan) {
  for (const study::PlanShape& shape : plan.shapes)
    (void)load_solids(shape.model);
  if (plan.run.masking != "white" && plan.run.masking != "off") check_wav(plan.run.masking);
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
  for (study::PlanShape& shape : plan.shapes)
    shape.model_sha256 = sha256_of_file(shape.model).sha256;
  return plan;
}

}  // namespace palpa::setup
