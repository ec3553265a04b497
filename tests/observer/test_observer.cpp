// The ideal observer on touches whose answers are known by other means.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

#include "base/files/sha256.hpp"
#include "base/random.hpp"
#include "observer/comparison.hpp"
#include "observer/decision.hpp"
#include "observer/placements.hpp"
#include "observer/predicted/prediction_reports.hpp"
#include "observer/prediction.hpp"
#include "study/tables/dprime.hpp"
#include "study/tables/paper.hpp"
#include "support/exhaustive.hpp"
#include "support/json.hpp"
#include "support/thrown.hpp"

namespace palpa::observer {
namespace {

using nlohmann::json;
using study::correct_of_dprime;
using study::paper_cross_section;
using study::paper_single_focus;

/// Four shapes with the same distance from each other, the same at each of three placements.
Templates equal_distances(double apart, Placement placement) {
  Templates templates{.shapes = 4, .placements = 3, .node_weights = {1}, .products = {}, .placement = placement};
  for (std::size_t a = 0; a < 12; ++a) {
    for (std::size_t b = 0; b < 12; ++b)
      templates.products.push_back(a / 3 == b / 3 ? apart * apart : 0);
  }
  return templates;
}

/// Three shapes at these places of a line, the same at each of three placements.
Templates on_a_line(const std::vector<double>& points) {
  Templates templates{.shapes = 3, .placements = 3, .node_weights = {1}, .products = {}};
  for (std::size_t a = 0; a < 9; ++a) {
    for (std::size_t b = 0; b < 9; ++b)
      templates.products.push_back(points[a / 3] * points[b / 3]);
  }
  return templates;
}

Normals normals_of(const Templates& templates) {
  return {templates.placements, templates.size()};
}

TEST(IdealObserver, EqualDistancesGiveTheAccuracyOfAChoiceOfFour) {
  // Orthogonal templates of length d: the answer is the largest of four normal values, one of them with a mean of d.
  for (const Placement placement : {Placement::known, Placement::unknown}) {
    const Templates templates = equal_distances(1, placement);
    const Observer observer(templates, normals_of(templates));
    for (const double dprime : {0.3, 1.0, 2.5}) {
      const Decisions decisions = observer.decide(1 / dprime);
      EXPECT_NEAR(decisions.accuracy, correct_of_dprime(dprime, 4), 0.003) << dprime;
      for (const double share : decisions.by_part)
        EXPECT_NEAR(share, decisions.accuracy, 0.02);
      double row = 0;
      for (std::size_t i = 0; i < 4; ++i)
        row += decisions.shares[i];
      EXPECT_NEAR(row, 1, 1e-9);
      EXPECT_NEAR(decisions.shares[1], decisions.shares[2], 0.01);
    }
    const double sigma = sigma_for(observer, templates, 0.39);
    EXPECT_NEAR(1 / sigma, 0.4892759241, 0.006);
    EXPECT_NEAR(observer.decide(sigma).accuracy, 0.39, 1e-4);
  }
  const Templates none = equal_distances(0, Placement::known);
  EXPECT_EQ(sigma_for(Observer(none, normals_of(none)), none, 0.39), 0);
}

TEST(IdealObserver, OneCloseShapeTakesTheErrors) {
  const Templates templates = on_a_line({0, 1, 10});
  const Decisions decisions = Observer(templates, normals_of(templates)).decide(1);
  // Two alternatives at a distance of one sigma: Phi(1/2).
  EXPECT_NEAR(decisions.shares[0], 0.6914624613, 0.002);
  EXPECT_NEAR(decisions.shares[4], 0.6914624613, 0.002);
  EXPECT_GT(decisions.shares[8], 0.999);
}

TEST(IdealObserver, LikelyDepthsCountMoreThanUnlikelyOnes) {
  // Two shapes that feel alike, but what is felt at the likely depth of one is felt at the unlikely depth of the other.
  // The answer is the shape whose likely touch is the nearer one, at a distance of one sigma from the middle:
  // right in 0.9 Phi(1) + 0.1 (1 - Phi(1)) of the touches.
  for (const Placement placement : {Placement::known, Placement::unknown}) {
    for (const std::vector<double>& weights : {std::vector{0.9, 0.1}, {0.1, 0.9}}) {
      Templates templates{
          .shapes = 2, .placements = 3, .node_weights = weights, .products = {}, .placement = placement};
      const auto place = [](std::size_t t) { return t / 6 == t % 2 ? 0.0 : 2.0; };
      for (std::size_t a = 0; a < 12; ++a) {
        for (std::size_t b = 0; b < 12; ++b)
          templates.products.push_back(place(a) * place(b));
      }
      const Normals normals(templates.placements, templates.size(), 2048);
      const Decisions decisions = Observer(templates, normals).decide(1);
      EXPECT_NEAR(decisions.accuracy, 0.7730757969, 0.006) << weights[0];
      EXPECT_NEAR(decisions.shares[1], 1 - 0.7730757969, 0.01) << weights[0];
    }
  }
}

TEST(IdealObserver, IdenticalShapesShareTheAnswers) {
  // Shapes that feel the same, alone and beside others.
  const Templates none = equal_distances(0, Placement::unknown);
  for (const double share : Observer(none, normals_of(none)).decide(1).shares)
    EXPECT_NEAR(share, 0.25, 1e-9);
  const Templates two = on_a_line({0, 0, 10});
  const Decisions decisions = Observer(two, normals_of(two)).decide(1);
  for (const std::size_t cell : {0u, 1u, 3u, 4u})
    EXPECT_NEAR(decisions.shares[cell], 0.5, 1e-3);
}

TEST(IdealObserver, PlacesRepresentThePrior) {
  const std::vector<FingerPlace> places = places_of({2e-3, 0.25}, 64);
  const auto mean = [&](const auto& of) {
    double sum = 0;
    for (const FingerPlace& place : places)
      sum += of(place);
    return sum / 64;
  };
  const std::array<double FingerPlace::*, 3> coordinates{&FingerPlace::x_m, &FingerPlace::z_m, &FingerPlace::yaw_rad};
  const std::array<double, 3> deviations{2e-3, 2e-3, 0.25}, off{0.1, 0.1, 0.05};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto share = [&](const FingerPlace& p) { return p.*coordinates[i] / deviations[i]; };
    EXPECT_NEAR(mean(share), 0, off[i]);
    EXPECT_NEAR(std::sqrt(mean([&](const FingerPlace& p) { return share(p) * share(p); })), 1, 0.1);
  }
  EXPECT_NEAR(mean([](const FingerPlace& p) { return p.x_m * p.z_m; }) / 4e-6, 0, 0.2);
  // More placements begin with the same.
  EXPECT_EQ(places_of({2e-3, 0.25}, 3)[2].z_m, places[2].z_m);
}

/// Touches that differ by shape, at a few sites; `strength` of each method multiplies the differences.
Responses made_up(const std::vector<double>& strengths) {
  Responses out{.shapes = study::paper_shapes(),
                .methods = {},
                .depths_m = {1e-3, 5e-3},
                .placements = 3,
                .levels = {{"16 mN", 0.3, 16e-3}, {"50 mN", 0.9, 50e-3}, {"linear", 1, 53e-3}},
                .areas_cm2 = {0.02, 0.03, 0.025},
                .seconds_counted = 0.3,
                .touches = {}};
  for (std::size_t m = 0; m < strengths.size(); ++m) {
    out.methods.push_back(m == 0 ? "single-focus" : m == 1 ? "cross-section" : "method " + std::to_string(m));
    for (std::size_t shape = 0; shape < 4; ++shape) {
      for (std::size_t d = 0; d < 2; ++d) {
        for (std::size_t place = 0; place < 3; ++place) {
          Random random(1000 * shape + d);
          Random at_place(7 + place);
          TouchResponse touch;
          const auto value = [&](double base) {
            return static_cast<float>(base * (1 + 0.3 * strengths[m] * random.normal() + 0.05 * at_place.normal()));
          };
          for (std::size_t level = 0; level < 3; ++level) {
            touch.counts.emplace_back();
            for (std::size_t i = 0; i < 3 * model_count; ++i)
              touch.counts.back().push_back(std::max(0.0F, value(30)));
          }
          touch.at_once = touch.counts[0];
          for (std::vector<float>* map : {&touch.mean_stress, &touch.flutter, &touch.vibration}) {
            for (std::size_t i = 0; i < 3; ++i)
              map->push_back(std::max(1e-6F, value(1e-3)));
          }
          out.touches.push_back(std::move(touch));
        }
      }
    }
  }
  return out;
}

const PredictedStudy paper_study{.fitted = {0, 0.39, 400}};

/// A prediction of three methods. The last two are almost the same.
const Prediction& shared_prediction() {
  static const Prediction prediction = predict(made_up({0.5, 1, 1.001}), paper_study, {.points = 1024});
  return prediction;
}

/// A study whose sound is weak. The first method is felt as at the reference, the second not at all.
Responses weak_study() {
  Responses responses = made_up({0.5, 1});
  responses.levels.insert(responses.levels.begin() + 2, {"plan (0.13 mN)", 0.0024, 0.13e-3, 0.05});
  for (std::size_t i = 0; i < responses.touches.size(); ++i) {
    std::vector<std::vector<float>>& counts = responses.touches[i].counts;
    const bool felt = i < responses.touches.size() / 2;
    counts.insert(counts.begin() + 2, felt ? counts[0] : std::vector<float>(counts[0].size(), 0));
  }
  return responses;
}

const Prediction& weak_prediction() {
  static const Prediction prediction = predict(weak_study(), paper_study, {.points = 128});
  return prediction;
}

/// At the level at which the study is run, the noise is that of the reference, however weak the sound is.
TEST(IdealObserver, ThePlansLevelKeepsTheNoise) {
  const Prediction& prediction = weak_prediction();
  EXPECT_EQ(prediction.levels.size(), 3u) << "those at which the noise is fitted";
  const PredictedVariant &reference = prediction.variants[0], &at_plan = prediction.at_plan.value().prediction;
  EXPECT_EQ(at_plan.sigma, reference.sigma);
  EXPECT_EQ(at_plan.methods[0].accuracy, reference.methods[0].accuracy);
  EXPECT_NEAR(at_plan.methods[1].accuracy, 0.25, 1e-9) << "guessed";
  for (const std::string& report : {prediction_text(prediction, {}, ""), prediction_html(prediction, {}, "")}) {
    EXPECT_CONTAINS(report,
                    "At the plan's ceiling of 0.05, the force at a single focus' crest is 0.13 mN, 123 times less "
                    "than the 16 mN to which the noise is fitted");
    EXPECT_CONTAINS(report, "so it is too narrow");
  }
}

TEST(IdealObserver, EveryVariantIsFittedToOneNumber) {
  const Prediction& prediction = shared_prediction();
  ASSERT_EQ(prediction.variants.size(), observer_variants().size());
  EXPECT_NEAR(prediction.fitted_interval.low, 0.3419209849, 1e-9);
  for (const PredictedVariant& variant : prediction.variants) {
    if (variant.methods.empty()) continue;
    EXPECT_NEAR(variant.methods[0].accuracy, 0.39, 1e-4) << variant.name;
    EXPECT_EQ(variant.methods[0].error, 0);
    for (const PredictedMethod& method : variant.methods) {
      EXPECT_LT(method.error, 0.005) << variant.name;
      ASSERT_TRUE(method.fitted_interval) << variant.name;
      EXPECT_LT(method.fitted_interval->low, method.accuracy) << variant.name;
      EXPECT_GT(method.fitted_interval->high, method.accuracy) << variant.name;
    }
  }
  const PredictedVariant& reference = prediction.variants[0];
  EXPECT_GT(reference.methods[1].accuracy, 0.5);
  // Levels ascend, and the reference is one of them.
  ASSERT_EQ(prediction.levels.size(), 3u);
  EXPECT_EQ(prediction.levels[0].prediction.methods[1].accuracy, reference.methods[1].accuracy);
  // Null models: guessing does not depend on the method; only the ratio of distances does.
  EXPECT_EQ(prediction.nulls[0].methods[1].accuracy, 0.39);
  EXPECT_NEAR(prediction.nulls[0].methods[1].shares[1], 0.61 / 3, 1e-12);
  EXPECT_GT(prediction.nulls[1].methods[1].accuracy, 0.5);
  // The methods 1 and 2 are almost the same, so they are tied; the first is far behind.
  ASSERT_EQ(prediction.ranking.size(), 3u);
  EXPECT_EQ(prediction.ranking[0].rank, 1u);
  EXPECT_EQ(prediction.ranking[1].rank, 1u);
  EXPECT_EQ(prediction.ranking[2].method, 0u);
  // 400 trials: the standard deviation of a mean is 0.024.
  EXPECT_NEAR(prediction.studies[0].high - prediction.studies[0].low, 4 * 0.024, 0.02);
}

TEST(IdealObserver, NumericalErrorOfAnAccuracy) {
  // With four times the draws, or eight, no accuracy changes by more than 0.005.
  const Responses responses = made_up({0.5, 1});
  const Variant& reference = observer_variants()[0];
  const Templates single = templates_of(responses, 0, reference, 0, 5),
                  cross = templates_of(responses, 1, reference, 0, 5);
  double accuracies[2];
  for (const std::size_t i : {0, 1}) {
    const std::size_t points = i == 0 ? default_points : (test::exhaustive() ? 8 : 4) * default_points;
    const Normals normals(single.placements, single.size(), points);
    const Observer observer(single, normals);
    accuracies[i] = Observer(cross, normals).decide(sigma_for(observer, single, 0.39)).accuracy;
  }
  EXPECT_NEAR(accuracies[0], accuracies[1], 0.005);
}

TEST(IdealObserver, KnowingThePlacementHelps) {
  // With the same noise. With noise that is fitted for each, it need not: a method that gains more from it gets more
  // noise.
  const Responses responses = made_up({0.5, 1});
  Variant unknown = observer_variants()[0], known = unknown;
  known.placement = Placement::known;
  for (const std::size_t method : {0, 1}) {
    const Templates one = templates_of(responses, method, unknown, 0, 5),
                    other = templates_of(responses, method, known, 0, 5);
    const Normals normals = normals_of(one);
    for (const double part : {0.1, 0.3, 1.0, 3.0}) {
      const double sigma = part * spread_of(one);
      EXPECT_GT(Observer(other, normals).decide(sigma).accuracy, Observer(one, normals).decide(sigma).accuracy - 0.003)
          << method << ' ' << part;
    }
  }
}

TEST(IdealObserver, TouchesThatAreAlikeCannotBeFitted) {
  EXPECT_ERROR(predict(made_up({0, 1}), paper_study, {.points = 128}), Exit::failed,
               "no internal noise gives single-focus an accuracy of 0.39");
}

TEST(IdealObserver, PeopleChangeOnlyTheComparison) {
  const Prediction& prediction = shared_prediction();
  const std::string document = prediction_document(prediction);
  study::Confusion other = paper_cross_section();
  std::ranges::reverse(other.counts);
  const Comparison paper = compare(
      prediction, {{"single-focus", "paper", paper_single_focus()}, {"cross-section", "paper", paper_cross_section()}});
  const Comparison changed = compare(prediction, {{"single-focus", "paper", paper_single_focus()},
                                                  {"cross-section", "paper", other},
                                                  {"ellipse", "paper", other}});
  ASSERT_EQ(paper.methods.size(), 2u);
  EXPECT_TRUE(paper.left_out.empty());
  ASSERT_EQ(changed.left_out.size(), 1u);
  EXPECT_CONTAINS(changed.left_out[0], "no such method");
  EXPECT_NE(paper.methods[1].variants[0].rms, changed.methods[1].variants[0].rms);
  EXPECT_EQ(paper.methods[0].variants[0].rms, changed.methods[0].variants[0].rms);
  EXPECT_EQ(prediction_document(prediction), document);
  const std::string one = prediction_json(prediction, paper, sha256(document)),
                    two = prediction_json(prediction, changed, sha256(document));
  const std::size_t end = one.find("\"beside\"");
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(one.substr(0, end), two.substr(0, end));
  EXPECT_NE(one, two);
  // The noise of the paper's tables: their own sampling, and how well a perfect prediction would correlate.
  EXPECT_NEAR(paper.methods[0].ceiling_rms, 0.040, 0.004);
  EXPECT_NEAR(paper.methods[1].ceiling_rms, 0.034, 0.004);
  EXPECT_NEAR(*paper.methods[0].ceiling_r, 0.91, 0.03);
  EXPECT_NEAR(*paper.methods[1].ceiling_r, 0.95, 0.03);
  EXPECT_NEAR(paper.methods[0].chance.rms, 0.114, 1e-3);
  EXPECT_NEAR(paper.methods[1].chance.rms, 0.245, 1e-3);
  EXPECT_NEAR(paper.methods[0].chance.log_likelihood, -1.386, 1e-3);
  EXPECT_NEAR(paper.methods[0].itself.log_likelihood, -1.284, 1e-3);
  EXPECT_NEAR(paper.methods[1].itself.log_likelihood, -0.936, 1e-3);
  EXPECT_EQ(paper.methods[0].itself.rms, 0);
}

TEST(IdealObserver, Reports) {
  const Prediction& prediction = shared_prediction();
  const Comparison paper = compare(prediction, {{"cross-section", "paper", paper_cross_section()}});
  const std::string text = prediction_text(prediction, paper, "0123"),
                    html = prediction_html(prediction, paper, "0123");
  EXPECT_CONTAINS(text, "fitted to single-focus 0.390 (156 of 400 trials");
  EXPECT_CONTAINS(text, "sha256 of the prediction: 0123");
  EXPECT_CONTAINS(text, "null: lapses");
  EXPECT_CONTAINS(html, "<svg");
  EXPECT_CONTAINS(html, "What should the next study try?");
  EXPECT_EQ(html.find("nan"), std::string::npos);
  // Figures whose marks are methods say which mark is which.
  for (const char* title : {"Predicted accuracy of each method with each variant", "Predicted accuracy by the level"}) {
    const std::size_t begin = html.find(title);
    ASSERT_NE(begin, std::string::npos) << title;
    const std::string figure = html.substr(begin, html.find("</svg>", begin) - begin);
    for (const std::string& method : prediction.methods)
      EXPECT_CONTAINS(figure, ">" + method + "<");
  }
}

/// A row's cells, without quotes.
std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : row) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

/// The number in a cell; null if the cell is empty.
json number_in(const std::string& cell) {
  return cell.empty() ? json() : json(std::stod(cell));
}

TEST(IdealObserver, TheCsvHasTheNumbersOfTheJson) {
  const Prediction& prediction = weak_prediction();
  const Comparison people = compare(
      prediction, {{"single-focus", "paper", paper_single_focus()}, {"cross-section", "paper", paper_cross_section()}});
  const json all = json::parse(prediction_json(prediction, people, "0123"));
  std::istringstream csv(prediction_csv(prediction, people));
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  EXPECT_EQ(line, "kind,variant,method,accuracy,low,high,error,rms,errors_r,log_likelihood");
  /// `fit`: its name in the comparison with people; empty: it is not compared.
  const auto expect_rows = [&](const std::string& kind, const std::string& name, const json& part,
                               const std::string& fit) {
    for (const json& method : part["methods"]) {
      const std::string of = method["method"];
      SCOPED_TRACE(kind + ' ' + name + ' ' + of);
      ASSERT_TRUE(std::getline(csv, line));
      const std::vector<std::string> cells = cells_of(line);
      ASSERT_EQ(cells.size(), 10u) << line;
      EXPECT_EQ(cells[0] + ' ' + cells[1] + ' ' + cells[2], kind + ' ' + name + ' ' + of);
      std::vector<json> expected{method["accuracy"], {}, {}, method["error"], {}, {}, {}};
      if (const json& interval = method["fitted_interval"]; !interval.is_null())
        expected[1] = interval[0], expected[2] = interval[1];
      for (const json& observed : all["beside"]) {
        for (const json& one : observed["fits"]) {
          if (observed["method"] != of || one["name"] != fit) continue;
          expected[4] = one["rms"], expected[5] = one["errors_r"], expected[6] = one["log_likelihood"];
        }
      }
      EXPECT_EQ(expected[4].is_null(), fit.empty());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const json is = number_in(cells[3 + i]);
        ASSERT_EQ(is.is_null(), expected[i].is_null()) << i;
        if (is.is_null()) continue;
        EXPECT_NEAR(is.get<double>(), expected[i].get<double>(), 1e-6) << i;
      }
    }
  };
  const json& predicted = all["prediction"];
  for (const json& variant : predicted["variants"])
    expect_rows("variant", variant["name"], variant, variant["name"]);
  for (const json& level : predicted["levels"])
    expect_rows("level", level["name"], level["prediction"], "");
  expect_rows("plan level", "plan (0.13 mN)", predicted["plan_level"]["prediction"], "");
  for (const json& null : predicted["nulls"])
    expect_rows("null", null["name"], null, "null: " + null["name"].get<std::string>());
  EXPECT_FALSE(std::getline(csv, line)) << line;
}

}  // namespace
}  // namespace palpa::observer
