#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "sweep/results.hpp"

namespace palpa::sweep {
namespace {

const std::string json =
    R"({"points": 3, "name": "a \"b\"", "depths": [0.25, 0.5, 1e-5], "fingers": [{"foci": [[1, 2, 3], null]}], "timing_ms": {"total": 7}})";

std::string one(const std::string& path) {
  return results_of(json, {path}).front();
}

TEST(SweepResults, PathsLeadToSingleValues) {
  EXPECT_EQ(one("points"), "3");
  EXPECT_EQ(one("name"), R"("a \"b\"")");
  EXPECT_EQ(one("depths.1"), "0.5");
  EXPECT_EQ(one("depths.count"), "3");
  EXPECT_EQ(one("depths.min"), "1e-05");
  EXPECT_EQ(one("depths.max"), "0.5");
  EXPECT_EQ(one("fingers.0.foci.0.sum"), "6");
  EXPECT_EQ(one("fingers.0.foci.0.mean"), "2");
  EXPECT_EQ(one("fingers.0.foci.count"), "2");
  EXPECT_EQ(one("fingers.0.foci.1"), "null");
  EXPECT_EQ(one("fingers.0.foci.mean"), "null") << "a list without numbers";
  EXPECT_EQ(one("fingers.7.foci.count"), "null");
  EXPECT_EQ(one("nothing.here"), "null");
  EXPECT_EQ(one("points.count"), "null");
}

TEST(SweepResults, APathToAListIsRefused) {
  try {
    one("fingers.0.foci");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "results: fingers.0.foci is a list; name one of its entries, such as fingers.0.foci.0, or "
                 "fingers.0.foci.count");
  }
  EXPECT_ERROR(one("fingers.0"), Exit::usage, "fingers.0 is an object; name one of its entries");
}

TEST(SweepResults, ANameThatIsMissingHasANearOne) {
  const auto fault = [](const std::string& path) { return name_fault(json, path); };
  EXPECT_EQ(fault("point"), "results: a case has no point; did you mean points?");
  EXPECT_EQ(fault("fingers.0.focii.count"), "results: fingers.0 has no focii; did you mean fingers.0.foci?");
  EXPECT_EQ(fault("depths.maxx"), "results: depths has no maxx; did you mean depths.max?");
  EXPECT_EQ(fault("nothing.here"), "results: a case has no nothing; it has points, name, depths, fingers, timing_ms");
  EXPECT_EQ(fault("points.count"), "results: points has no count; leave it out");
  for (const char* path : {"points", "depths.1", "depths.count", "fingers.count", "fingers.0.count", "fingers.7.x",
                           "fingers.0.foci.1", "fingers.0.foci.1.2"})
    EXPECT_EQ(fault(path), "") << path;
}

TEST(SweepResults, EverythingIsOneLineWithoutTimes) {
  const std::string text = without_times(json);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(text.find("timing"), std::string::npos);
  EXPECT_EQ(results_of(text, {"depths.2"}).front(), "1e-05");
}

}  // namespace
}  // namespace palpa::sweep
