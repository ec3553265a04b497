#include "cli/support/touch_json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/support/here.hpp"

namespace palpa::test {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> names;
  for (const auto& item : object.items())
    names.push_back(item.key());
  return names;
}

Vec3 vector_of(const Json& value) {
  EXPECT_EQ(value.size(), 3u);
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

template <typename T>
void expect_ascending(const std::vector<T>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    ASSERT_LT(values[i - 1], values[i]) << "at " << i;
}

void check_axes(const Json& finger) {
  const Vec3 w1 = vector_of(finger["axes"][0]), w2 = vector_of(finger["axes"][1]), w3 = vector_of(finger["axes"][2]);
  EXPECT_EQ(finger["axes"].size(), 3u);
  EXPECT_LT(glm::distance(glm::cross(w3, w1), w2), 1e-5);
  const Vec3 eigenvalues = vector_of(finger["eigenvalues_m2"]);
  EXPECT_GE(eigenvalues.x, eigenvalues.y);
  EXPECT_GE(eigenvalues.y, eigenvalues.z);
  EXPECT_GE(eigenvalues.z, 0);
}

void check_foci(const Json& finger, std::size_t most) {
  const Json& foci = finger["foci_m"];
  const Json& counts = finger["focus_points"];
  EXPECT_TRUE(foci.size() == most || foci.size() == 1) << foci.size();
  ASSERT_EQ(counts.size(), foci.size());
  std::uint64_t sum = 0;
  for (std::size_t n = 0; n < foci.size(); ++n) {
    const auto points = counts[n].get<std::uint64_t>();
    EXPECT_EQ(foci[n].is_null(), points == 0) << "sector " << n;
    sum += points;
  }
  EXPECT_EQ(sum, finger["indices"].size());
}

void check_document(const Json& document, double delta, std::size_t foci) {
  EXPECT_EQ(keys(document), (std::vector<std::string>{"points", "contacts", "fingers", "schedule", "backend",
                                                      "backend_why", "timing_ms"}));
  EXPECT_EQ(keys(document["contacts"]), (std::vector<std::string>{"count", "indices", "depths_m"}));
  EXPECT_EQ(keys(document["schedule"]), (std::vector<std::string>{"order", "dwell_s"}));
  EXPECT_EQ(keys(document["timing_ms"]).front(), "total");
  EXPECT_GE(keys(document["timing_ms"]).size(), 2u) << "no stage's time";
  for (const Json& time : document["timing_ms"])
    EXPECT_GE(time.get<double>(), 0);

  const auto contacts = document["contacts"]["indices"].get<std::vector<std::uint32_t>>();
  EXPECT_EQ(document["contacts"]["count"].get<std::size_t>(), contacts.size());
  EXPECT_EQ(document["contacts"]["depths_m"].size(), contacts.size());
  expect_ascending(contacts);
  for (const Json& depth : document["contacts"]["depths_m"]) {
    EXPECT_GT(depth.get<double>(), 0);
    EXPECT_LT(depth.get<double>(), delta);
  }
  const std::set<std::uint32_t> all(contacts.begin(), contacts.end());
  std::set<std::uint32_t> taken;
  std::vector<std::uint32_t> firsts;
  for (const Json& finger : document["fingers"]) {
    EXPECT_EQ(keys(finger), (std::vector<std::string>{"solid", "indices", "centroid_m", "axes", "eigenvalues_m2",
                                                      "foci_m", "focus_points"}));
    const auto indices = finger["indices"].get<std::vector<std::uint32_t>>();
    ASSERT_FALSE(indices.empty());
    expect_ascending(indices);
    for (const std::uint32_t index : indices) {
      EXPECT_TRUE(all.contains(index)) << index << " is no contact";
      EXPECT_TRUE(taken.insert(index).second) << index << " is in two fingers";
    }
    firsts.push_back(indices.front());
    check_axes(finger);
    check_foci(finger, foci);
  }
  expect_ascending(firsts);
  auto order = document["schedule"]["order"].get<std::vector<std::size_t>>();
  EXPECT_EQ(order.size(), foci);
  std::sort(order.begin(), order.end());
  for (std::size_t n = 0; n < order.size(); ++n)
    EXPECT_EQ(order[n], n) << "the order is no permutation";
}

}  // namespace

TouchReport read_touch(const std::string& text, double delta, std::size_t foci) {
  TouchReport report;
  Json document = Json::parse(text);
  check_document(document, delta, foci);
  report.points = document["points"].get<std::uint64_t>();
  report.contacts = document["contacts"]["indices"].get<std::vector<std::uint32_t>>();
  report.depths = document["contacts"]["depths_m"].get<std::vector<double>>();
  for (const Json& finger : document["fingers"]) {
    report.fingers.push_back(
        {finger["solid"], finger["indices"].get<std::vector<std::uint32_t>>(), vector_of(finger["centroid_m"])});
  }
  report.without_times = text.substr(0, text.find("\"backend\""));
  return report;
}

TouchReport run_touch_here(const std::vector<std::string>& line, double delta, std::size_t foci) {
  const Result result = succeeded(palpa_here(with(line, {"--json", "-"})));
  EXPECT_EQ(result.err, "");
  return result.exit_code == 0 ? read_touch(result.out, delta, foci) : TouchReport();
}

}  // namespace palpa::test
