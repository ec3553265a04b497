// The air, and the sound of drives at many points at once: against published values and the definition in doubles.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/pressure.hpp"
#include "acoustics/rigs.hpp"
#include "base/error.hpp"
#include "support/thrown.hpp"

namespace palpa::acoustics {
namespace {

using namespace array;
using Complex = std::complex<double>;

TEST(Air, AbsorbsAsTheStandardSays) {
  const struct {
    double celsius, humidity, db_per_metre;
  } known[]{{20, 50, 1.318}, {25, 50, 1.392}, {30, 50, 1.340}, {15, 30, 0.790}, {20, 30, 1.068}};
  for (const auto& [celsius, humidity, db_per_metre] : known) {
    const Air air = air_of({.celsius = celsius, .humidity_percent = humidity});
    EXPECT_NEAR(air.absorption_np_m * 20 / std::log(10), db_per_metre, 1e-3) << celsius;
  }
  EXPECT_NEAR(air_of({}).density_kg_m3, 1.2041, 1e-4);
  EXPECT_NEAR(air_of({}).medium.sound_speed, 343.21, 0.01);
  EXPECT_NEAR(air_of({.celsius = 30}).medium.sound_speed, 349.02, 0.01);
  EXPECT_EQ(air_of({.celsius = 30}, 25e3, 340).medium.sound_speed, 340);
  EXPECT_EQ(air_of({.celsius = 30}, 25e3, 340).density_kg_m3, air_of({.celsius = 30}).density_kg_m3);
  EXPECT_EQ(without_absorption(air_of({})).absorption_np_m, 0);
}

TEST(Air, RefusesValuesOutOfRange) {
  const std::pair<Weather, const char*> none[]{{{.celsius = -61}, "temperature -61"},
                                               {{.celsius = 101}, "temperature 101"},
                                               {{.humidity_percent = -1}, "humidity of -1 percent"},
                                               {{.humidity_percent = 101}, "humidity of 101 percent"},
                                               {{.humidity_percent = NAN}, "humidity of nan percent"},
                                               {{.pressure_pa = 1013.25}, "pressure of 1013.25 Pa"},
                                               {{.pressure_pa = 1e6}, "pressure of 1000000 Pa"}};
  for (const auto& one : none)
    EXPECT_ERROR(air_of(one.first), Exit::usage, one.second);
  EXPECT_ERROR(air_of({}, 10), Exit::usage, "frequency of 10 Hz");
  EXPECT_ERROR(air_of({}, 40e3, 10), Exit::usage, "sound speed of 10 m/s");
}

/// docs/limits.md has these limits.
TEST(Air, TakesTheLastValueOfEachRangeAndRefusesTheNext) {
  struct Case {
    const char* what;
    double low, high;
    std::function<Air(double)> air;
  };
  for (const Case& one : {Case{"temperature", -60, 100, [](double value) { return air_of({.celsius = value}); }},
                          {"humidity", 0, 100, [](double value) { return air_of({.humidity_percent = value}); }},
                          {"air pressure", 20e3, 500e3, [](double value) { return air_of({.pressure_pa = value}); }},
                          {"frequency", 1e3, 10e6, [](double value) { return air_of({}, value); }},
                          {"sound speed", 100, 2000, [](double value) { return air_of({}, 40e3, value); }}}) {
    SCOPED_TRACE(one.what);
    for (const double value : {one.low, one.high})
      EXPECT_TRUE(std::isfinite(one.air(value).absorption_np_m)) << value;
    for (const double value : {std::nextafter(one.low, -1e9), std::nextafter(one.high, 1e9)})
      EXPECT_ERROR(one.air(value), Exit::usage, one.what);
  }
}

/// Drives of a layout in which all values differ.
struct Scene {
  Layout layout;
  std::vector<Drive> drives;
  Strengths strengths;
  std::vector<Vec3> points, normals;

  Scene(const std::string& name, std::size_t drive_count, std::size_t point_count, double half_size) {
    layout = load_layout(name);
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    for (std::size_t d = 0; d < drive_count; ++d) {
      Drive drive;
      for (std::size_t t = 0; t < layout.transducers.size(); ++t)
        drive.push_back({static_cast<float>(uniform(0, 1)), static_cast<float>(uniform(-3.14, 3.14))});
      const Strengths add = strengths_of(drive);
      strengths.insert(strengths.end(), add.begin(), add.end());
      drives.push_back(drive);
    }
    for (std::size_t i = 0; i < point_count; ++i) {
      points.emplace_back(uniform(-half_size, half_size), uniform(-half_size, half_size),
                          uniform(-half_size, half_size));
      normals.push_back(glm::normalize(Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))));
    }
  }
};

TEST(Incident, IsTheDefinitionsSum) {
  const Air air = air_of({});
  for (const Directivity kind : {Directivity::omni, Directivity::piston, Directivity::t4010a1}) {
    const Scene scene("paper", 2, 70, 0.12);
    Waves waves;
    ASSERT_TRUE(Incident(scene.layout, air, kind).at(scene.points, scene.normals, scene.strengths, waves));
    std::vector<Complex> pressures, slopes;
    for (const Drive& drive : scene.drives) {
      const auto pressure = [&](const Vec3& at) {
        return pressure_at(scene.layout, drive, at, air.medium, kind, air.absorption_np_m);
      };
      for (std::size_t i = 0; i < scene.points.size(); ++i) {
        pressures.push_back(pressure(scene.points[i]));
        const double step = 2e-6;
        slopes.push_back((pressure(scene.points[i] + step * scene.normals[i]) -
                          pressure(scene.points[i] - step * scene.normals[i])) /
                         (2 * step));
      }
    }
    // The directivity is interpolated from a table.
    const double most = kind == Directivity::omni ? 2e-6 : 2e-5;
    EXPECT_LT(relative_error(waves.pressures, pressures), most);
    EXPECT_LT(relative_error(waves.slopes, slopes), kind == Directivity::omni ? 1e-5 : 2e-4);
  }
}

TEST(Incident, IsExactFarAndNear) {
  Scene scene("openmpd", 1, 1, 1);
  scene.points = {{0, 0, 50}, {30, -40, 20}, {0, 0, 0.003}, scene.layout.transducers[17].position};
  const Air air = air_of({});
  Waves waves;
  Incident(scene.layout, air, Directivity::t4010a1).at(scene.points, {}, scene.strengths, waves);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const Complex expected = pressure_at(scene.layout, scene.drives[0], scene.points[i], air.medium,
                                         Directivity::t4010a1, air.absorption_np_m);
    EXPECT_LT(std::abs(waves.pressures[i] - expected), 2e-5 * std::abs(expected)) << i;
  }
  EXPECT_TRUE(waves.slopes.empty());
}

/// Sources and receivers are exchanged.
TEST(Incident, ReceivesWhatItSends) {
  const Scene scene("autd3", 3, 131, 0.1);
  const Incident incident(scene.layout, air_of({}), Directivity::piston);
  Waves sent;
  incident.at(scene.points, scene.normals, scene.strengths, sent);
  Strengths loud;
  for (std::size_t i = 0; i < 2 * scene.points.size(); ++i)
    loud.push_back(std::polar(1.0 + 0.01 * static_cast<double>(i), 0.3 * static_cast<double>(i)));
  const Complex slope(0.4e-3, -1.1e-3);
  std::vector<Complex> received;
  ASSERT_TRUE(incident.received(scene.points, scene.normals, loud, slope, received));
  const std::size_t transducers = scene.layout.transducers.size(), points = scene.points.size();
  ASSERT_EQ(received.size(), 2 * transducers);
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t d = 0; d < 3; ++d) {
      Complex here = 0, there = 0;
      for (std::size_t i = 0; i < points; ++i)
        here += loud[row * points + i] * (sent.pressures[d * points + i] + slope * sent.slopes[d * points + i]);
      for (std::size_t t = 0; t < transducers; ++t)
        there += scene.strengths[d * transducers + t] * received[row * transducers + t];
      EXPECT_LT(std::abs(here - there), 1e-5 * std::abs(here));
    }
  }
}

TEST(Incident, GivesUpWhenTold) {
  const Scene scene("autd3", 1, 10, 0.1);
  const Incident incident(scene.layout, air_of({}), Directivity::omni);
  const std::atomic<bool> give_up = true;
  Waves waves;
  EXPECT_FALSE(incident.at(scene.points, {}, scene.strengths, waves, &give_up));
  EXPECT_TRUE(incident.at({}, {}, scene.strengths, waves));
  EXPECT_TRUE(waves.pressures.empty());
}

}  // namespace
}  // namespace palpa::acoustics
