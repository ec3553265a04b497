// A user's program: presses a finger 3 mm into a model and drives the paper's array for it, slot by slot.
//   feel MODEL.glb FINGER.ply
#include <algorithm>
#include <cstdio>
#include <vector>

#include "array/drive.hpp"
#include "base/error.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/solid.hpp"
#include "touch/stage.hpp"

int main(int argc, char** argv) try {
  using namespace palpa;
  if (argc != 3) throw bad_usage("usage: feel MODEL.glb FINGER.ply");

  const std::vector<geometry::Solid> solids = geometry::make_solids(geometry::load_gltf(argv[1]));
  std::vector<glm::vec3> skin;
  for (const Vec3& point : geometry::read_ply(argv[2]).positions) {
    skin.emplace_back(point - Vec3(0, 0.003, 0));
  }

  touch::Touch touch;
  touch::Stage(solids).touch(sensing::numbered(skin), touch);

  const array::Layout paper = array::load_layout("paper");
  const array::Layout layout = array::transformed(paper, paper.default_T_world_layout);
  array::Drive drive(layout.transducers.size());
  int drives = 0;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    for (const touch::Focus& focus : touch.fingers[f].foci) {
      if (focus.points == 0) continue;
      const array::SlotFocus slot{Vec3(focus.position), 1.0f};
      array::drive_for(layout, {&slot, 1}, array::DriveOptions{}, drive);
      drives += std::any_of(drive.begin(), drive.end(), [](const auto& d) { return d.amplitude == 1.0f; });
    }
  }
  std::printf("%zu contacts, %u fingers, %d drives of %zu transducers\n", touch.contacts.size(), touch.finger_count,
              drives, drive.size());
  return touch.finger_count == 1 && drives == 10 && drive.size() == 3984 ? 0 : 1;
} catch (const palpa::Error& error) {
  std::fprintf(stderr, "feel: %s\n", error.what());
  return static_cast<int>(error.code());
}
