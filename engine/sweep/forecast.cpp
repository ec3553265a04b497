#include "sweep/forecast.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "sweep/store.hpp"

namespace palpa::sweep {
namespace {

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The time of each result, divided by the model's.
std::vector<double> ratios_of(const std::vector<Case>& all, const std::string& out, setup::Backend backend) {
  std::unordered_map<std::string_view, double> models;
  for (const Case& one : all)
    models.emplace(one.id, one.cost.all_s(backend));
  std::vector<double> ratios;
  const Store store(out);
  store.each([&](std::size_t run, std::string_view id, State state, std::string_view line) {
    const auto model = models.find(id);
    if ((store.runs()[run].backend == "cpu") != (backend == setup::Backend::cpu)) return;
    if (state != State::done || model == models.end() || !(model->second > 0)) return;
    const auto json = nlohmann::json::parse(line, nullptr, false);
    const bool is_timed = json.is_object() && json.contains("took_s") && json["took_s"].is_number();
    const double took_s = is_timed ? json["took_s"].get<double>() : 0.0;
    if (took_s > 0) ratios.push_back(took_s / model->second);
  });
  return ratios;
}

}  // namespace

Forecast forecast_of(const std::vector<Case>& all, const std::vector<Case>& some, const std::string& out,
                     setup::Backend backend) {
  Forecast forecast{.cases = some.size()};
  if (!out.empty()) {
    const std::vector<double> ratios = ratios_of(all, out, backend);
    forecast.measured = ratios.size();
    if (!ratios.empty()) forecast.factor = median_of(ratios);
  }
  if (some.empty()) return forecast;
  std::vector<double> seconds;
  for (const Case& one : some) {
    seconds.push_back(one.cost.all_s(backend) * forecast.factor);
    forecast.all_s += seconds.back();
    forecast.most_bytes = std::max(forecast.most_bytes, one.cost.bytes);
  }
  const auto [least, most] = std::ranges::minmax(seconds);
  forecast.least_s = least;
  forecast.most_s = most;
  forecast.median_s = median_of(std::move(seconds));
  return forecast;
}

}  // namespace palpa::sweep
