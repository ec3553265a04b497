#include "observer/afferents/skin_load.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>

#include "observer/afferents/half_space.hpp"

namespace palpa::observer {
namespace {

constexpr double per_pa = 1e-6;    // N/mm2
constexpr double stress_mm = 0.3;  // the depth of SA1
constexpr double highest_hz = 1000;

struct Face {
  std::array<Vec3, 3> corners;  // mm
  Vec3 centroid{0};
  double area = 0, radius = 0;  // mm2, and of a disc of that area
};

std::vector<Face> faces_of(const geometry::Mesh& body, const SkinSites& sites) {
  std::vector<Face> faces;
  for (const std::uint32_t f : sites.faces) {
    const glm::uvec3& t = body.triangles[f];
    Face face{{body.positions[t.x] * 1e3, body.positions[t.y] * 1e3, body.positions[t.z] * 1e3}};
    const auto& [a, b, c] = face.corners;
    face.centroid = (a + b + c) / 3.0;
    face.area = glm::length(glm::cross(b - a, c - a)) / 2;
    face.radius = std::sqrt(face.area / std::numbers::pi);
    faces.push_back(face);
  }
  return faces;
}

/// The stress at `site` from a pressure of 1 on the face, which is divided into small triangles where it is near.
double stress_from(const Face& face, const Vec3& site) {
  const double distance = std::sqrt(std::pow(glm::distance(face.centroid, site), 2) + stress_mm * stress_mm);
  const auto& [a, b, c] = face.corners;
  const double side = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const int parts = std::clamp(static_cast<int>(std::ceil(4 * side / distance)), 1, 16);
  double sum = 0;
  const Vec3 u = (b - a) / static_cast<double>(parts), v = (c - a) / static_cast<double>(parts);
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      const Vec3 corner = a + static_cast<double>(i) * u + static_cast<double>(j) * v;
      sum += stress_of_point(stress_mm, glm::distance(corner + (u + v) / 3.0, site));
      if (i + j + 1 < parts) sum += stress_of_point(stress_mm, glm::distance(corner + 2.0 / 3.0 * (u + v), site));
    }
  }
  return sum * face.area / (parts * parts);
}

}  // namespace

SkinLoad::SkinLoad(const geometry::Mesh& body, const SkinSites& sites, Delays delays, double wave_m_s)
    : sites_(sites.positions.size()) {
  const std::vector<Face> faces = faces_of(body, sites);
  // Stress from farther away is below 1e-5 of the pressure on a face of 1 mm2.
  constexpr double stress_reach = 8;
  for (const Vec3& position : sites.positions) {
    const Vec3 site = position * 1e3;
    stress_begin_.push_back(stress_.size());
    deflection_begin_.push_back(deflection_.size());
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      const Face& face = faces[f];
      const double distance = glm::distance(face.centroid, site);
      if (distance < stress_reach) stress_.push_back({f, 0, stress_from(face, site) * per_pa});
      Part part{f, 0, deflection_of_disc(face.radius, distance) * per_pa};
      if (delays == Delays::waves) {
        const double wave_s = std::max(0.0, distance - face.radius) / (wave_m_s * 1e3);
        part.delay = static_cast<std::uint32_t>(std::lround(wave_s * afferent_rate_hz));
      }
      delays_ = std::max<std::size_t>(delays_, part.delay + 1);
      deflection_.push_back(part);
    }
    // Parts of one delay lie together, so that sums stay in the processor's cache.
    std::stable_sort(deflection_.begin() + static_cast<std::ptrdiff_t>(deflection_begin_.back()), deflection_.end(),
                     [](const Part& a, const Part& b) { return a.delay < b.delay; });
  }
  stress_begin_.push_back(stress_.size());
  deflection_begin_.push_back(deflection_.size());
}

std::vector<double> SkinLoad::stress(std::span<const float> map) const {
  std::vector<double> sums(sites_);
  for (std::size_t s = 0; s < sites_; ++s) {
    for (std::size_t i = stress_begin_[s]; i < stress_begin_[s + 1]; ++i)
      sums[s] += stress_[i].weight * static_cast<double>(map[stress_[i].face]);
  }
  return sums;
}

std::vector<double> SkinLoad::deflections(std::span<const float> map) const {
  std::vector<double> sums(sites_ * delays_);
  for (std::size_t s = 0; s < sites_; ++s) {
    for (std::size_t i = deflection_begin_[s]; i < deflection_begin_[s + 1]; ++i)
      sums[s * delays_ + deflection_[i].delay] += deflection_[i].weight * static_cast<double>(map[deflection_[i].face]);
  }
  return sums;
}

SkinUnderPattern::SkinUnderPattern(const SkinLoad& load, const PressurePattern& pattern, std::size_t samples)
    : load_(load), period_s_(pattern.period_s()), samples_(samples) {
  for (const std::vector<float>& map : pattern.maps) {
    stress_.push_back(load.stress(map));
    deflections_.push_back(load.deflections(map));
  }
  for (std::size_t n = 0; n <= samples; ++n)
    sounding_.push_back(sounding(pattern, n, afferent_rate_hz));
}

std::vector<double> SkinUnderPattern::deflection(std::size_t site, std::size_t samples) const {
  std::vector<double> sums(samples);
  const std::size_t delays = load_.delays();
  // From here on, it repeats if the period is a whole number of samples.
  const double period = period_s_ * afferent_rate_hz, whole = std::round(period);
  const bool repeats = std::abs(period - whole) < 1e-9;
  const auto step = static_cast<std::size_t>(whole);
  for (std::size_t n = 0; n < samples; ++n) {
    if (repeats && n >= delays + step) {
      sums[n] = sums[n - step];
      continue;
    }
    double sum = 0;
    for (std::size_t delay = 0; delay < std::min(delays, n + 1); ++delay) {
      for (const auto& [map, weight] : sounding_[n - delay])
        sum += weight * deflections_[map][site * delays + delay];
    }
    sums[n] = sum;
  }
  return sums;
}

SkinMotion SkinUnderPattern::motion() const {
  SkinMotion motion{SiteSignal(load_.sites(), samples_), SiteSignal(load_.sites(), samples_)};
  for (std::size_t s = 0; s < load_.sites(); ++s) {
    const std::vector<double> surface = deflection(s, samples_ + 1);
    for (std::size_t n = 0; n < samples_; ++n) {
      motion.velocity.at(s, n) = (surface[n + 1] - (n > 0 ? surface[n - 1] : 0)) / 2 * afferent_rate_hz;
      double stress = 0;
      for (const auto& [map, weight] : sounding_[n])
        stress += weight * stress_[map][s];
      motion.stress.at(s, n) = stress;
    }
  }
  return motion;
}

std::size_t SkinUnderPattern::whole_cycles() const {
  const double room = static_cast<double>(samples_) - static_cast<double>(load_.delays());
  const double period = period_s_ * afferent_rate_hz;
  const double cycles = std::floor(room / period + 1e-9);
  return cycles < 1 ? samples_ : static_cast<std::size_t>(std::lround(cycles * period));
}

std::vector<double> SkinUnderPattern::mean_stress() const {
  const std::size_t samples = whole_cycles();
  std::vector<double> share(stress_.size()), sums(load_.sites());
  for (std::size_t n = 0; n < samples; ++n) {
    for (const auto& [map, weight] : sounding_[n])
      share[map] += weight / static_cast<double>(samples);
  }
  for (std::size_t map = 0; map < stress_.size(); ++map) {
    for (std::size_t s = 0; s < sums.size(); ++s)
      sums[s] += share[map] * stress_[map][s];
  }
  return sums;
}

SkinUnderPattern::Lines SkinUnderPattern::lines() const {
  Lines lines;
  for (int m = 1; m / period_s_ <= highest_hz; ++m)
    lines.hz.push_back(m / period_s_);
  // One cycle is sufficient if it is a whole number of samples. The last one is in the steady state.
  const double period = period_s_ * afferent_rate_hz;
  const bool repeats = std::abs(period - std::round(period)) < 1e-9;
  const std::size_t whole = whole_cycles();
  const std::size_t samples = repeats ? std::min(whole, static_cast<std::size_t>(std::lround(period))) : whole;
  const std::size_t from = samples_ - samples;
  std::vector<std::complex<double>> turns;
  for (const double hz : lines.hz) {
    for (std::size_t n = 0; n < samples; ++n)
      turns.push_back(std::polar(1.0, -2 * std::numbers::pi * hz * static_cast<double>(n) / afferent_rate_hz));
  }
  for (std::size_t s = 0; s < load_.sites(); ++s) {
    const std::vector<double> surface = deflection(s, samples_);
    for (std::size_t m = 0; m < lines.hz.size(); ++m) {
      std::complex<double> sum = 0;
      for (std::size_t n = 0; n < samples; ++n)
        sum += surface[from + n] * turns[m * samples + n];
      lines.amplitudes.push_back(2 * std::abs(sum) / static_cast<double>(samples));
    }
  }
  return lines;
}

}  // namespace palpa::observer
