#include "sweep/shard.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "base/error.hpp"
#include "base/text.hpp"

namespace palpa::sweep {
namespace {

constexpr std::uint32_t most_parts = 1'000'000;

std::optional<std::uint32_t> whole(std::string_view text) {
  std::uint32_t number = 0;
  const auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || fault != std::errc{} || rest != text.data() + text.size()) return std::nullopt;
  return number;
}

Shard checked(std::optional<std::uint32_t> index, std::optional<std::uint32_t> count, const std::string& fault) {
  if (!index || !count || *count == 0 || *count > most_parts || *index >= *count) throw bad_usage(fault);
  return {*index, *count};
}

/// The variable's whole number. Throws bad_usage if it is missing or something else.
std::uint32_t needed(const Environment& variable, const std::string& name) {
  const std::optional<std::string> text = variable(name);
  const std::optional<std::uint32_t> number = text ? whole(*text) : std::nullopt;
  if (!number) {
    throw bad_usage(fmt::format("--shard env: {} is {}, not a whole number", name,
                                text ? "'" + printable(*text, 40) + "'" : "not set"));
  }
  return *number;
}

Shard ranked(const Environment& variable, const std::string& rank, const std::string& size) {
  const std::uint32_t index = needed(variable, rank), count = needed(variable, size);
  return checked(index, count, fmt::format("--shard env: {} is {} and {} is {}", rank, index, size, count));
}

Shard of_array(const Environment& variable) {
  const std::uint32_t id = needed(variable, "SLURM_ARRAY_TASK_ID"), least = needed(variable, "SLURM_ARRAY_TASK_MIN");
  const std::uint32_t most = needed(variable, "SLURM_ARRAY_TASK_MAX");
  const std::uint32_t count = needed(variable, "SLURM_ARRAY_TASK_COUNT");
  if (most < least || most - least + 1 != count) {
    throw bad_usage(fmt::format(
        "--shard env: the job array {} to {} has {} tasks; give it the step 1 and no gaps, such as --array=0-{}", least,
        most, count, count > 0 ? count - 1 : 0));
  }
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const std::optional<std::string> text = variable(size);
    if (text && whole(*text).value_or(0) > 1) {
      throw bad_usage(fmt::format(
          "--shard env: a task of a job array that starts {} processes would compute every case {} times; start one",
          *text, *text));
    }
  }
  return checked(id - least, count,
                 fmt::format("--shard env: SLURM_ARRAY_TASK_ID is {}, not {} to {}", id, least, most));
}

Shard from_environment(const Environment& variable) {
  if (variable("SLURM_ARRAY_TASK_ID")) return of_array(variable);
  if (variable("OMPI_COMM_WORLD_RANK")) return ranked(variable, "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE");
  if (variable("PMI_RANK")) return ranked(variable, "PMI_RANK", "PMI_SIZE");
  if (variable("SLURM_PROCID")) {
    if (variable("SLURM_STEP_NUM_TASKS")) return ranked(variable, "SLURM_PROCID", "SLURM_STEP_NUM_TASKS");
    const std::optional<std::string> tasks = variable("SLURM_NTASKS");
    if (tasks && whole(*tasks).value_or(0) > 1) {
      throw bad_usage(fmt::format(
          "--shard env: the job has {} tasks, but this process was not started by srun: use srun palpa sweep", *tasks));
    }
    return {0, 1};
  }
  throw bad_usage(
      "--shard env: none of SLURM_ARRAY_TASK_ID, OMPI_COMM_WORLD_RANK, PMI_RANK and SLURM_PROCID is set; without a "
      "scheduler, give the shard yourself, such as --shard 0/8");
}

}  // namespace

std::optional<std::string> environment(const std::string& name) {
  const char* const value = std::getenv(name.c_str());
  return value ? std::optional<std::string>(value) : std::nullopt;
}

Shard parse_shard(const std::string& text, const Environment& variable) {
  if (text == "env") return from_environment(variable);
  const std::size_t slash = text.find('/');
  const std::string fault = fmt::format(
      "--shard: '{}' is not a shard i/n with i from 0 to n - 1, such as 0/8 to 7/8, and not env", printable(text, 40));
  if (slash == std::string::npos) throw bad_usage(fault);
  return checked(whole(std::string_view(text).substr(0, slash)), whole(std::string_view(text).substr(slash + 1)),
                 fault);
}

}  // namespace palpa::sweep
