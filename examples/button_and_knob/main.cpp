// A mid-air button and a knob.
//   button_and_knob assets/button-and-knob.glb assets/finger.ply
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/error.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "session/session.hpp"

int main(int argc, char** argv) try {
  using namespace palpa;
  if (argc != 3) throw bad_usage("usage: button_and_knob SCENE.glb FINGER.ply");
  session::Session session({.solids = geometry::make_solids(geometry::load_gltf(argv[1]))});
  const std::vector<Vec3> finger = geometry::read_ply(argv[2]).positions;
  std::vector<glm::vec3> skin(finger.size());
  const Vec3 axis(0.08, 0, 0);  // the knob's
  double before = 0, turned = 0;

  for (int frame = 0; frame <= 270; ++frame) {
    // Your hand tracker says where the skin is. This one presses the button, then goes half way round the knob.
    const double time_s = frame / 90.0, angle = std::numbers::pi / 2 * (time_s - 1);
    const Vec3 press(0, 0.002 - 0.006 * std::sin(std::numbers::pi * time_s), 0);
    const Vec3 tip = time_s < 1 ? press : axis + Vec3(0.02 * std::cos(angle), -0.001, -0.02 * std::sin(angle));
    for (std::size_t i = 0; i < skin.size(); ++i)
      skin[i] = finger[i] + tip;

    session.touch(skin, time_s);
    for (const session::Event& event : session.events()) {
      const double now = std::atan2(axis.z - event.centroid.z, event.centroid.x - axis.x);
      if (event.kind == session::EventKind::press) std::printf("%.2f s: button pressed\n", event.time_s);
      if (session.solid_name(event) != "knob") continue;
      if (event.kind == session::EventKind::move) turned += std::remainder(now - before, 2 * std::numbers::pi);
      before = now;
    }
  }
  std::printf("knob turned by %.0f degrees\n", turned * 180 / std::numbers::pi);
  return 0;
} catch (const palpa::Error& error) {
  std::fprintf(stderr, "button_and_knob: %s\n", error.what());
  return static_cast<int>(error.code());
}
