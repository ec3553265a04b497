#include "hand_motion.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "support/shared_data.hpp"

namespace palpa::test {

std::string unpacked(const std::filesystem::path& file) {
  std::string text;
  const gzFile in = gzopen(file.c_str(), "rb");
  char part[1 << 16];
  for (int got = in ? gzread(in, part, sizeof(part)) : 0; got > 0; got = gzread(in, part, sizeof(part)))
    text.append(part, static_cast<std::size_t>(got));
  if (in) gzclose(in);
  return text;
}

namespace {

/// The tips FT1 to FT5 of a trial, every second frame: 75 Hz.
void read_markers(const std::string& trial, std::initializer_list<int> fingers, std::vector<TipPath>& out) {
  const std::filesystem::path file = shared_data("hand-motion/" + trial + ".mocap.csv.gz");
  if (file.empty()) return;
  std::istringstream lines(unpacked(file));
  std::string line;
  std::getline(lines, line);
  std::vector<TipPath> tips(fingers.size());
  for (std::size_t row = 0; std::getline(lines, line); ++row) {
    if (row % 2 != 0) continue;
    std::istringstream cells(line);
    std::vector<double> values;
    for (double value = 0; cells >> value;)
      values.push_back(value);
    if (values.size() < 17) break;
    std::size_t tip = 0;
    for (const int finger : fingers) {
      const double* at = values.data() + 2 + 3 * (finger - 1);
      tips[tip].time_s.push_back(static_cast<double>(row) / 150);
      tips[tip++].place_m.push_back(Vec3(at[0], at[1], at[2]) * 1e-3);
    }
  }
  for (TipPath& tip : tips) {
    tip.name = trial;
    tip.faithful = true;
    out.push_back(std::move(tip));
  }
}

void read_leap(const std::string& name, std::vector<TipPath>& out) {
  const std::filesystem::path file = shared_data("hand-motion/" + name + ".leap6.jsonl.gz");
  if (file.empty()) return;
  std::istringstream lines(unpacked(file));
  std::map<int, TipPath> tips;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json frame = nlohmann::json::parse(line);
    const double time_s = frame["timestamp"].get<double>() * 1e-6;
    for (const auto& pointable : frame["pointables"]) {
      if (!pointable.contains("type") || pointable["tool"] == true) continue;
      TipPath& tip = tips[pointable["id"].get<int>()];
      if (!tip.time_s.empty() && (time_s <= tip.end_s() || time_s > tip.end_s() + 0.05)) continue;
      const auto& at = pointable["tipPosition"];
      tip.name = name;
      tip.time_s.push_back(time_s);
      tip.place_m.push_back(Vec3(at[0].get<double>(), at[1].get<double>(), at[2].get<double>()) * 1e-3);
    }
  }
  for (auto& [id, tip] : tips) {
    if (tip.time_s.size() > 60) out.push_back(std::move(tip));
  }
}

double rms(double sum, std::size_t count) {
  return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

Vec3 TipPath::at(double t) const {
  const auto after = std::upper_bound(time_s.begin(), time_s.end(), t);
  if (after == time_s.begin()) return place_m.front();
  if (after == time_s.end()) return place_m.back();
  const auto i = static_cast<std::size_t>(after - time_s.begin());
  return glm::mix(place_m[i - 1], place_m[i], (t - time_s[i - 1]) / (time_s[i] - time_s[i - 1]));
}

Vec3 TipPath::velocity_at(double t, double over_s) const {
  return (at(t + over_s / 2) - at(t - over_s / 2)) / over_s;
}

TipPath TipPath::thinned(std::size_t n) const {
  TipPath out{name, {}, {}, faithful};
  for (std::size_t i = 0; i < time_s.size(); i += n) {
    out.time_s.push_back(time_s[i]);
    out.place_m.push_back(place_m[i]);
  }
  return out;
}

std::vector<TipPath> marker_tips() {
  std::vector<TipPath> tips;
  for (const char* trial :
       {"Index_flexion_trial0", "Index_flexion_trial1", "Index_flexion_trial2", "Index_flexion_trial3"})
    read_markers(trial, {2, 3}, tips);
  for (const char* trial : {"Middle_flexion_trial0", "Middle_flexion_trial2", "Middle_flexion_trial3"})
    read_markers(trial, {3, 4}, tips);
  read_markers("Thumb_flexion_trial0", {1, 2}, tips);
  return tips;
}

std::vector<TipPath> leap_tips() {
  std::vector<TipPath> tips;
  for (const char* name :
       {"HandSplay-110fps", "Waiting-110fps", "pinch", "grab", "rollAndPitchWithEntry", "brian", "flapping", "wave"})
    read_leap(name, tips);
  return tips;
}

PredictionError error_of(const std::vector<TipPath>& paths, const std::function<TipPredictor()>& make, double ahead_s,
                         double noise_m) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  struct Sum {
    double predicted = 0, held = 0;
    std::size_t count = 0;
    void add(double p, double h) {
      predicted += p * p;
      held += h * h;
      ++count;
    }
    double ratio() const { return count == 0 ? 0 : rms(predicted, count) / rms(held, count); }
  } move, rest, turn;
  std::vector<double> errors, held_errors;
  for (const TipPath& path : paths) {
    const TipPredictor predictor = make();
    for (std::size_t i = 0; i < path.time_s.size(); ++i) {
      const double t = path.time_s[i];
      const Vec3 seen = path.place_m[i] + noise_m * Vec3(normal(random), normal(random), normal(random));
      predictor.see(t, seen);
      if (t < path.begin_s() + 0.3 || t + ahead_s > path.end_s() - 0.1) continue;
      const Vec3 truth = path.at(t + ahead_s);
      const double error = glm::distance(predictor.at(ahead_s), truth), held = glm::distance(seen, truth);
      const Vec3 now = path.velocity_at(t, 0.03);
      double fastest = 0;
      for (double s = t - 0.1; s <= t + 0.1; s += 0.01)
        fastest = std::max(fastest, glm::length(path.velocity_at(s, 0.03)));
      if (glm::length(now) > 0.1) {
        move.add(error, held);
        errors.push_back(error);
        held_errors.push_back(held);
      }
      if (fastest < 0.03) rest.add(error, held);
      bool turns = false;
      for (double s = t - 0.03; s <= t + ahead_s + 0.03 && glm::length(now) > 0.1; s += 0.01)
        turns = turns || glm::dot(path.velocity_at(s, 0.03), now) < 0;
      if (turns) turn.add(error, held);
    }
  }
  return {move.ratio(), rest.ratio(), turn.ratio(), median_of(errors) / std::max(median_of(held_errors), 1e-9),
          move.count,   rest.count,   turn.count};
}

}  // namespace palpa::test
