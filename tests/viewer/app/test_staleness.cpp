// The parts of a picture that are updated, and when the file of a scene is read again.
#include "viewer/app/staleness.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/app/opening.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

TEST(Staleness, ALargeUpdateIncludesSmallerOnes) {
  ViewState state;
  Staleness stale;
  EXPECT_TRUE(stale.dirty());
  EXPECT_EQ(stale.take(state), Stale::surfaces) << "nothing was drawn yet";
  stale.drew();
  EXPECT_EQ(stale.what(), Stale::nothing);
  stale.add(Stale::nothing);
  stale.look(state);
  EXPECT_FALSE(stale.dirty());
  stale.add(Stale::skin);
  stale.add(Stale::marks);
  EXPECT_TRUE(stale.dirty());
  EXPECT_EQ(stale.take(state), Stale::skin);
  EXPECT_EQ(stale.take(state), Stale::nothing);
}

TEST(Staleness, MarksFollowAllThatTheyAreDrawnWith) {
  const auto drawn_again = [](auto change) {
    ViewState state;
    Staleness stale;
    stale.take(state);
    stale.drew();
    change(state);
    stale.look(state);
    return stale.what() == Stale::marks;
  };
  EXPECT_TRUE(drawn_again([](ViewState& state) { state.layers[Layer::foci].visible = false; }));
  EXPECT_TRUE(drawn_again([](ViewState& state) { state.explode = 0.5; }));
  EXPECT_TRUE(drawn_again([](ViewState& state) { state.slice.size_m.x = 0.01; }));
  EXPECT_TRUE(drawn_again([](ViewState& state) { state.slice_handles = !state.slice_handles; }));
  EXPECT_TRUE(drawn_again([](ViewState& state) { state.picked.emplace(); }));
  EXPECT_TRUE(drawn_again([](ViewState& state) { state.dark = !state.dark; }));
}

TEST(Staleness, OtherSurfacesHaveAnotherNumber) {
  ViewState state;
  Staleness stale;
  stale.take(state);
  const std::uint64_t before = stale.surfaces_version();
  stale.add(Stale::skin);
  state.dark = true;
  stale.look(state);
  EXPECT_EQ(stale.surfaces_version(), before);
  EXPECT_EQ(stale.take(state), Stale::skin);
  state.explode = 0.5;
  stale.look(state);
  EXPECT_NE(stale.surfaces_version(), before) << "parts are elsewhere";
  EXPECT_EQ(stale.take(state), Stale::marks);
  const std::uint64_t apart = stale.surfaces_version();
  stale.add(Stale::surfaces);
  EXPECT_NE(stale.surfaces_version(), apart);
}

TEST(SceneWatch, AFileIsReadAgainOnceItHasSettled) {
  const fs::path folder = test::scratch_folder("viewer-scene-watch"), scene = folder / "scene.glb",
                 other = folder / "other.glb";
  test::write_text(scene, "1");
  test::write_text(other, "2");
  const auto write = [](const fs::path& file) { fs::last_write_time(file, fs::last_write_time(file) + 1s); };
  SceneWatch watch;
  EXPECT_FALSE(watch.look(scene, 0)) << "it is new";
  EXPECT_EQ(watch.next_s(), 1);
  write(scene);
  EXPECT_FALSE(watch.look(scene, 0.5)) << "too early";
  EXPECT_FALSE(watch.look(scene, 1)) << "more may come";
  EXPECT_TRUE(watch.look(scene, 2));
  EXPECT_FALSE(watch.look(scene, 3)) << "once";
  write(scene);
  EXPECT_FALSE(watch.look(scene, 4));
  double now_s = 4;
  for (const std::string& another : {other.string(), other.string(), std::string(), (folder / "nowhere.glb").string()})
    EXPECT_FALSE(watch.look(another, ++now_s)) << another;
}

TEST(SceneWatch, TheFileBesideAGltfIsOneOfItsFiles) {
  const fs::path scene = test::scratch_folder("viewer-scene-beside") / "scene.gltf",
                 beside = fs::path(scene).replace_extension(".bin");
  test::write_text(scene, "1");
  test::write_text(beside, "2");
  SceneWatch watch;
  EXPECT_FALSE(watch.look(scene, 0));
  fs::last_write_time(beside, fs::last_write_time(beside) + 1s);
  EXPECT_FALSE(watch.look(scene, 1));
  EXPECT_TRUE(watch.look(scene, 2));
}

}  // namespace
}  // namespace palpa::viewer
