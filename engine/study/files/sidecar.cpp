#include "study/files/sidecar.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/text.hpp"
#include "study/files/trial.hpp"

namespace palpa::study {
namespace {

/// Keeps the order of keys, which is the order of the shapes.
using Json = nlohmann::ordered_json;

Json read_object(const std::filesystem::path& file) {
  constexpr std::uint64_t most_bytes = 1 << 20;
  Json document = Json::parse(read_text_file(file, most_bytes), nullptr, false);
  if (!document.is_object()) throw bad_input(file.string(), "is not a JSON object");
  return document;
}

std::vector<std::string> levels_of(const Json& document, const std::string& file) {
  std::vector<std::string> shapes;
  const auto column = document.find("shape");
  if (column == document.end()) return shapes;
  if (!column->is_object()) throw bad_input(file, "\"shape\" is not an object");
  const auto levels = column->find("Levels");
  if (levels == column->end()) return shapes;
  if (!levels->is_object()) throw bad_input(file, "\"Levels\" of \"shape\" is not an object");
  for (const auto& [name, description] : levels->items()) {
    if (name.empty() || name.size() > most_name)
      throw bad_input(file, fmt::format("\"Levels\" of \"shape\": '{}' is not a name of 1 to {} letters",
                                        printable(name, 60), most_name));
    if (std::ranges::find(shapes, name) == shapes.end()) shapes.push_back(name);
  }
  if (shapes.size() > most_shapes)
    throw bad_input(file, fmt::format("has {} shapes, at most {} are analysed", shapes.size(), most_shapes));
  return shapes;
}

double number_at(const Json& document, const char* key, const std::string& file) {
  const auto found = document.find(key);
  if (found == document.end() || !found->is_number() || !std::isfinite(found->get<double>()))
    throw bad_input(file, fmt::format("\"{}\" is missing or not a number", key));
  return found->get<double>();
}

}  // namespace

EventsSidecar read_events_sidecar(const std::filesystem::path& file) {
  const Json document = read_object(file);
  const auto version = document.find("PalpaStudyVersion");
  if (version == document.end() || !version->is_number_unsigned())
    throw bad_input(
        file.string(),
        fmt::format("\"PalpaStudyVersion\" is missing or not a whole number: it should be {}", log_version));
  if (const auto number = version->get<std::uint64_t>(); number != log_version)
    throw bad_input(file.string(),
                    fmt::format("the log has version {}, this palpa reads version {}", number, log_version));
  EventsSidecar sidecar{.shapes = levels_of(document, file.string())};
  if (const auto found = document.find("Rehearsal"); found != document.end())
    sidecar.rehearsal = found->is_boolean() && found->get<bool>();
  if (const auto plan = document.find("PlanSha256"); plan != document.end() && plan->is_string())
    sidecar.plan_sha256 = plan->get<std::string>();
  if (const auto least = document.find("LeastTrials"); least != document.end()) {
    constexpr std::uint64_t most = 1'000'000;
    if (!least->is_number_unsigned() || least->get<std::uint64_t>() > most)
      throw bad_input(file.string(), fmt::format("\"LeastTrials\" is not a whole number from 0 to {}", most));
    sidecar.least_trials = least->get<std::uint32_t>();
  }
  if (const auto sum = document.find("EventsCrc32"); sum != document.end()) {
    std::size_t used = 0;
    const std::string digits = sum->is_string() ? sum->get<std::string>() : "";
    if (digits.size() == 8 && digits.find_first_not_of("0123456789abcdef") == std::string::npos)
      sidecar.checksum = static_cast<std::uint32_t>(std::stoul(digits, &used, 16));
    if (used != 8) throw bad_input(file.string(), "\"EventsCrc32\" is not eight digits from 0 to f");
  }
  return sidecar;
}

FingerSidecar read_finger_sidecar(const std::filesystem::path& file) {
  const Json document = read_object(file);
  FingerSidecar sidecar{.rate_hz = number_at(document, "SamplingFrequency", file.string()),
                        .start_s = number_at(document, "StartTime", file.string())};
  constexpr double most_hz = 10e3;
  if (sidecar.rate_hz <= 0 || sidecar.rate_hz > most_hz)
    throw bad_input(file.string(),
                    fmt::format("\"SamplingFrequency\" {} is not above 0 and at most {} Hz", sidecar.rate_hz, most_hz));
  const auto columns = document.find("Columns");
  if (columns == document.end() || !columns->is_array())
    throw bad_input(file.string(), "\"Columns\" is missing or not an array");
  sidecar.columns = sidecar.depth_column = columns->size();
  for (std::size_t i = 0; i < columns->size(); ++i) {
    if ((*columns)[i].is_string() && (*columns)[i].get<std::string>() == "depth") sidecar.depth_column = i;
  }
  if (sidecar.depth_column == sidecar.columns) throw bad_input(file.string(), "\"Columns\" has no \"depth\"");
  return sidecar;
}

}  // namespace palpa::study
