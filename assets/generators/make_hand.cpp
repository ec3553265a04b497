// make_hand --pose spread|point|relaxed|fist -o OUT.glb: writes the hand in that pose (assets/generators/hand.hpp).
#include <cstring>
#include <string>

#include "assets/generators/hand.hpp"
#include "assets/generators/program.hpp"
#include "geometry/gltf/write.hpp"

int main(int argc, char** argv) {
  return palpa::assets::run_program([&] {
    std::string pose_name, out;
    bool understood = argc == 5;
    for (int i = 1; understood && i + 1 < argc; i += 2) {
      if (std::strcmp(argv[i], "--pose") == 0)
        pose_name = argv[i + 1];
      else if (std::strcmp(argv[i], "-o") == 0)
        out = argv[i + 1];
      else
        understood = false;
    }
    const auto pose = palpa::assets::named_hand_pose(pose_name);
    if (!understood || !pose || out.empty())
      throw palpa::bad_usage("usage: " + std::string(argv[0]) + " --pose spread|point|relaxed|fist -o OUT.glb");
    const palpa::geometry::SceneMesh hand{"hand", palpa::assets::make_hand(*pose)};
    palpa::geometry::write_glb(out, {&hand, 1});
  });
}
