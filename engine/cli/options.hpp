// The option groups that several programs and subcommands share. Each is a struct of values with the defaults of the
// command line's contract, an `add` that puts its options on a command, and, where values depend on each other, a
// `check` to call once the line is parsed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/log.hpp"
#include "gpu/device.hpp"

namespace CLI {
class App;
}

namespace palpa::cli {

enum class Backend { gpu, cpu };

/// Every subcommand has these.
struct CommonOptions {
  std::string gpu;  ///< part of a device's name or its index; empty: the fastest kind present
  Backend backend = Backend::gpu;
  std::string json;  ///< a file, "-" for stdout, empty for none
  bool quiet = false;
  std::optional<log::Level> log_level;
  std::uint64_t seed = 0;
  std::optional<gpu::Validation> validation;
};
void add_common(CLI::App& app, CommonOptions& options);
/// Sets the log level: --log-level, else "error" with --quiet, else "warning".
void apply_logging(const CommonOptions& options);
gpu::DeviceOptions device_options(const CommonOptions& options);

}  // namespace palpa::cli
