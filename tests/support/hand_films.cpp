#include "support/hand_films.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// Half of the noise of depth_noise.hpp, smoothed by [1 2 1]/4 in both directions, without its faults at rims.
void add_half_noise(const sensing::Camera& camera, std::uint64_t key, std::vector<std::uint16_t>& depth) {
  const std::size_t w = camera.width, h = camera.height;
  std::mt19937_64 random(key);
  std::vector<float> white(w * h), rows(w * h);
  for (float& value : white) {  // the sum of four draws is nearly normal
    const std::uint64_t draw = random();
    const auto sum =
        static_cast<double>((draw & 0xffff) + (draw >> 16 & 0xffff) + (draw >> 32 & 0xffff) + (draw >> 48));
    value = static_cast<float>((sum / 65536 - 2) * std::sqrt(3.0));
  }
  for (std::size_t v = 0; v < h; ++v) {
    for (std::size_t u = 1; u + 1 < w; ++u)
      rows[v * w + u] = white[v * w + u - 1] + 2 * white[v * w + u] + white[v * w + u + 1];
  }
  const double disparity = camera.fx * sensing::D415::baseline_m;
  for (std::size_t v = 1; v + 1 < h; ++v) {
    for (std::size_t u = 1; u + 1 < w; ++u) {
      std::uint16_t& raw = depth[v * w + u];
      if (raw == 0) continue;
      // Both smoothings together leave 6 of a single draw's standard deviation.
      const double noise = (rows[(v - 1) * w + u] + 2 * rows[v * w + u] + rows[(v + 1) * w + u]) / 6.0;
      const double z = raw * camera.depth_unit_m;
      const double seen = disparity / (disparity / z + 0.5 * sensing::D415::sigma_px * noise);
      raw = static_cast<std::uint16_t>(std::lround(seen / camera.depth_unit_m));
    }
  }
}

}  // namespace

HandScene fingers_scene(int count, double thickness_m, double press_m, double tilt_deg, double plate_m) {
  const HandSkin& finger = finger_skin();
  const double scale = thickness_m / 18e-3;
  HandScene scene{.plate_m = plate_m, .digits = static_cast<std::uint32_t>(count)};
  for (int f = 0; f < count; ++f) {
    Transform T = turned({1, 0, 0}, tilt_deg);
    for (int k = 0; k < 3; ++k)
      T[k] *= scale;
    T[3] = Vec4((f - (count - 1) / 2.0) * thickness_m, 0, 0, 1);
    scene.skin.push_back({&finger.mesh, pressed(finger.mesh, T, press_m),
                          std::vector<std::uint32_t>(finger.part.size(), std::uint32_t(f))});
  }
  return scene;
}

HandScene hand_scene(const std::string& pose, double press_m, double tilt_deg, double plate_m, double turn_deg) {
  const HandSkin& hand = hand_skin(*assets::named_hand_pose(pose));
  HandScene scene{.name = pose, .plate_m = plate_m, .digits = hand.parts};
  const Transform T = turned({0, 1, 0}, 180 + turn_deg) * turned({1, 0, 0}, -tilt_deg);
  scene.skin.push_back({&hand.mesh, pressed(hand.mesh, T, press_m), hand.part});
  return scene;
}

std::vector<double> HandFilm::apart(const Vec3& place, std::size_t frame) const {
  std::vector<double> least(scene.digits, 1e9);
  for (std::size_t s = 0; s < scene.skin.size(); ++s) {
    const HandScene::Skin& skin = scene.skin[s];
    for (std::size_t i = 0; i < skin.digit.size(); ++i) {
      const Vec3 world = transform_point(skin.T_world_mesh, skin.mesh->positions[i]) + moved[frame][s];
      least[skin.digit[i]] = std::min(least[skin.digit[i]], glm::distance(world, place));
    }
  }
  return least;
}

HandFilm::Truth HandFilm::nearest(const Vec3& place, std::size_t frame) const {
  const std::vector<double> all = apart(place, frame);
  const auto best = std::ranges::min_element(all);
  return {static_cast<std::uint32_t>(best - all.begin()), *best};
}

HandFilm make_film(const HandScene& scene, const FilmSetting& setting) {
  HandFilm film{.scene = scene, .cameras = sensing::load_rig(source_file("assets/rigs/paper.toml")).cameras};
  film.cameras.resize(static_cast<std::size_t>(setting.cameras));
  sensing::SyntheticRig rig(
      film.cameras, {}, setting.noise == FilmNoise::full ? sensing::Noise::d415 : sensing::Noise::none, setting.seed);
  sensing::FrameSet still;
  for (std::size_t k = 0; k < setting.frames; ++k) {
    const double time_s = static_cast<double>(k) / setting.rate_hz;
    std::vector<Vec3>& moved = film.moved.emplace_back();
    std::vector<sensing::Posed> skin;
    for (std::size_t s = 0; s < scene.skin.size(); ++s) {
      moved.push_back(setting.motion ? setting.motion(s, time_s) : Vec3(0));
      Transform T = scene.skin[s].T_world_mesh;
      T[3] += Vec4(moved.back(), 0);
      skin.push_back({scene.skin[s].mesh, T});
    }
    sensing::FrameSet& set = film.frames.emplace_back();
    if (setting.motion || setting.noise == FilmNoise::full || k == 0) {
      rig.render(skin, k, still);
    }
    set = still;
    set.sequence = k;
    set.time_s = time_s;
    for (std::size_t c = 0; c < set.frames.size(); ++c) {
      set.frames[c].time_s = time_s;
      if (setting.noise == FilmNoise::half)
        add_half_noise(film.cameras[c], sensing::noise_key(setting.seed, k, c), set.frames[c].depth);
    }
  }
  return film;
}

}  // namespace palpa::test
