// One number for everything that the device computes from single frames. It must be the same on every run, and the test
// matrix compares it between thread counts, vector widths, staging and sanitizers. test_drive_pass and test_solver_pass
// cover drives of several simultaneous foci; test_followed_bytes covers state that passes from frame to frame.
#include <gtest/gtest.h>

#include <array>

#include "array/layouts/board_mesh.hpp"
#include "sensing/synthetic.hpp"
#include "session/session.hpp"
#include "support/digest.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

using test::Digest;

void add(Digest& digest, const touch::Touch& touch) {
  for (const touch::Contact& contact : touch.contacts) {
    digest.add(contact.point);
    digest.add(contact.solid);
    digest.add(contact.depth_m);
    digest.add(contact.position);
  }
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    for (const std::uint32_t contact : finger.contacts)
      digest.add(contact);
    digest.add(finger.section.centroid);
    for (int i = 0; i < 3; ++i) {
      digest.add(finger.section.axes[i]);
      digest.add(finger.section.eigenvalues[i]);
    }
    for (const touch::Focus& focus : finger.foci) {
      digest.add(focus.points);
      if (focus.points > 0) digest.add(focus.position);
    }
  }
}

struct Scene {
  const char* model;
  const char* skin;
  double lowered_m;
};
constexpr std::array scenes{Scene{"cube", "finger", 0.003}, Scene{"semi-sphere", "finger", 0.003},
                            Scene{"pyramid", "finger", 0.003}, Scene{"prism", "finger", 0.003},
                            Scene{"cube", "hand-point", 0.003}};

/// One digest per scene.
std::vector<std::uint64_t> digests_of(std::span<const Scene> some) {
  const std::vector<sensing::Camera> cameras = test::paper_cameras();
  const array::Layout layout = array::load_layout("paper");
  sensing::SyntheticRig synthetic(cameras, array::board_mesh(layout), sensing::Noise::d415, 1);
  std::vector<std::uint64_t> digests;
  for (const Scene& scene : some) {
    Digest digest;
    geometry::Mesh skin;
    if (std::string(scene.skin) == "finger") {
      skin = test::finger_skin().mesh;
    } else {
      const auto model = geometry::load_gltf(test::source_file(std::string("assets/") + scene.skin + ".glb"));
      for (const auto& part : model.meshes)
        geometry::append(skin, part.mesh);
    }
    const auto solids = test::asset_solids(scene.model);
    sensing::FrameSet frame;
    Transform T(1.0);
    T[3] = Vec4(0, -scene.lowered_m, 0, 1);
    const sensing::Posed posed{&skin, T};
    synthetic.render(std::span(&posed, 1), 0, frame);
    for (const auto& image : frame.frames) {
      for (const std::uint16_t depth : image.depth)
        digest.add(depth);
    }
    // Events make a touch contain its contacts and the skin below them.
    Session session(test::test_device(),
                    {.scene = scene.model, .solids = solids, .cameras = cameras, .layout = layout});
    const touch::Touch& touch = session.touch(frame.frames, 0);
    EXPECT_FALSE(touch.contacts.empty()) << scene.model;
    add(digest, touch);
    for (const auto& drive : session.plan().drives) {
      digest.add(drive.amplitude);
      digest.add(drive.phase);
    }
    digests.push_back(digest.value());
  }
  return digests;
}

TEST(SameBytes, OnEveryRunAndInEveryLegOfTheMatrix) {
  const std::vector<std::uint64_t> first = digests_of(scenes);
  EXPECT_EQ(digests_of(std::span(scenes).first(1))[0], first[0]);
  Digest all;
  for (const std::uint64_t one : first)
    all.add(one);
  test::tell_digest("touch", all.value());
}

}  // namespace
}  // namespace palpa::session
