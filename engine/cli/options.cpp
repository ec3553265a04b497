#include "cli/options.hpp"

#include "cli/values.hpp"

namespace palpa::cli {

void add_common(CLI::App& app, CommonOptions& options) {
  const Group group(app, "Common options");
  group.text("--gpu", options.gpu, "NAME|INDEX", "GPU to use, as `palpa doctor` lists them");
  group.choice("--backend", options.backend, {{"gpu", Backend::gpu}, {"cpu", Backend::cpu}}, "where to compute");
  group.text("--json", options.json, "FILE|-", "write the results as JSON, - for stdout");
  group.flag("--quiet", options.quiet, "no summary, no progress, no warnings");
  group.choice("--log-level", options.log_level,
               {{"quiet", std::optional(log::Level::quiet)},
                {"error", std::optional(log::Level::error)},
                {"warning", std::optional(log::Level::warning)},
                {"info", std::optional(log::Level::info)},
                {"debug", std::optional(log::Level::debug)}},
               "what stderr shows [warning]");
  group.integer("--seed", options.seed, 0, ~std::uint64_t{0}, "for whatever is random");
  group.choice("--validation", options.validation,
               {{"off", std::optional(gpu::Validation::off)},
                {"core", std::optional(gpu::Validation::core)},
                {"sync", std::optional(gpu::Validation::sync)},
                {"gpu-assisted", std::optional(gpu::Validation::gpu_assisted)}},
               "Vulkan validation [$PALPA_VALIDATION or off]");
}

void apply_logging(const CommonOptions& options) {
  log::set_level(options.log_level.value_or(options.quiet ? log::Level::error : log::Level::warning));
}

gpu::DeviceOptions device_options(const CommonOptions& options) {
  gpu::DeviceOptions device;
  device.select = options.gpu;
  device.validation = options.validation;
  return device;
}

}  // namespace palpa::cli
