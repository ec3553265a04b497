// Pictures of sound, computed in the background of the drawing: nothing waits, outdated pictures say so, and results
// are right.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>

#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "support/begins.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "viewer/hands/slice_hand.hpp"
#include "viewer/live/played.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/sound/sounds.hpp"

namespace palpa::viewer {
namespace {

using test::Played;
using Kind = WindowEvent::Kind;
constexpr std::chrono::milliseconds without_rest(0);

std::string ball() {
  const auto file = test::scratch_folder("viewer-sound") / "ball.ply";
  const geometry::Mesh mesh = geometry::icosphere(5e-3, 5);
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file.string();
}

/// The largest one of a vertex's red.
double difference(const std::vector<drawing::Colour>& before, const Picture& picture) {
  double largest = 0;
  for (std::size_t v = 0; v < before.size(); ++v)
    largest = std::max<double>(largest, std::abs(picture.skin->colours[v].r - before[v].r));
  return largest;
}

TEST(Heat, IsOfWhatSoundsOrSaysThatItIsNot) {
  Played played;
  played.now.tip = Vec3(0, 0, 0.1);
  Heat heat(ball(), played.now.air);
  Picture picture;
  heat.look(played.now, picture);
  EXPECT_FALSE(picture.skin) << "nobody waits for it";
  ASSERT_EQ(picture.bars.size(), 1u);
  EXPECT_CONTAINS(note_of(picture.bars[0]), "being computed");
  bool skin = false;
  const auto rests = [&] {
    skin = heat.look(played.now, picture).skin || skin;
    return !heat.busy();
  };
  ASSERT_TRUE(test::begins(rests));
  EXPECT_TRUE(skin);
  EXPECT_EQ(heat.fault(), "");
  EXPECT_FALSE(is_stale(picture, Layer::heat));
  ASSERT_TRUE(picture.skin);
  // Upright with its lowest vertex at the tip.
  const Box box = geometry::bounds(picture.skin->mesh);
  EXPECT_NEAR(box.low.y, 0, 1e-12);
  EXPECT_NEAR(box.centre().z, 0.1, 1e-9);
  const std::vector<drawing::Colour> before = picture.skin->colours;
  ASSERT_EQ(before.size(), picture.skin->mesh.positions.size());

  played.move({0.1e-3, 0, 0.1});
  EXPECT_FALSE(heat.look(played.now, picture).skin);
  EXPECT_FALSE(is_stale(picture, Layer::heat)) << "nobody sees a tenth of a millimetre";
  played.move({0, 4e-3, 0.1});
  heat.look(played.now, picture);
  EXPECT_TRUE(is_stale(picture, Layer::heat));
  EXPECT_TRUE(picture.skin) << "the one before, dimmer";
  ASSERT_TRUE(test::begins(rests));
  EXPECT_FALSE(is_stale(picture, Layer::heat));
  EXPECT_GT(difference(before, picture), 0.1);

  // The same place as a pose. Then the finger only turns: by less than its far end shows, and by more.
  const geometry::Mesh mesh = geometry::icosphere(5e-3, 5);
  const Vec3 lowest = *std::ranges::min_element(mesh.positions, {}, [](const Vec3& p) { return p.y; });
  const auto turn = [&](double angle) {
    played.now.T_world_finger =
        glm::rotate(glm::translate(Transform(1.0), *played.now.tip - lowest), angle, glm::normalize(Vec3(1, 2, 3)));
    heat.look(played.now, picture);
  };
  for (const double angle : {0.0, 4e-3}) {
    turn(angle);
    EXPECT_FALSE(is_stale(picture, Layer::heat)) << angle;
  }
  turn(0.3);
  EXPECT_TRUE(is_stale(picture, Layer::heat));
  ASSERT_TRUE(test::begins(rests));
  for (const std::size_t v : {std::size_t{0}, mesh.positions.size() / 2})
    EXPECT_LT(
        glm::distance(picture.skin->mesh.positions[v], transform_point(*played.now.T_world_finger, mesh.positions[v])),
        1e-6);

  played.now.T_world_finger.reset();
  played.now.tip.reset();
  EXPECT_TRUE(heat.look(played.now, picture).skin);
  EXPECT_FALSE(picture.skin) << "nobody touches";
  EXPECT_TRUE(picture.bars.empty());
  played.now.tip = Vec3(0, 0, 0.1);
  ASSERT_TRUE(test::begins(rests));
  EXPECT_TRUE(picture.skin) << "the same again";
}

/// What is not computed again.
TEST(Sounding, IsAlikeOnlyIfAllThatSoundsIs) {
  const Played played;
  array::Schedule before = *played.now.schedule;
  before.add_voice() = played.now.schedule->voices[0];
  const auto changed = [&](const std::function<void(array::Schedule&, array::Voice&)>& change) {
    array::Schedule after = before;
    change(after, after.voices[1]);
    return after;
  };
  using array::Schedule;
  using array::Voice;
  const std::pair<const char*, std::function<void(Schedule&, Voice&)>> changes[]{
      {"slots", [](Schedule& s, Voice&) { s.slot_s *= 2; }},
      {"fingers", [](Schedule& s, Voice&) { s.voice_count = 1; }},
      {"order", [](Schedule&, Voice& v) { std::swap(v.order[0], v.order[1]); }},
      {"foci per slot", [](Schedule&, Voice& v) { v.foci_per_slot = 4; }},
      {"dwell", [](Schedule&, Voice& v) { v.dwell_s *= 2; }},
      {"modulation", [](Schedule&, Voice& v) { v.modulation_hz = 200; }},
      {"kind of modulation", [](Schedule&, Voice& v) { v.modulation = array::Modulation::amplitude_sine; }},
      {"gain", [](Schedule&, Voice& v) { v.gain = 0.9; }},
      {"requested pressure", [](Schedule&, Voice& v) { v.pressure_pa = 1e3; }},
      {"a focus more", [](Schedule&, Voice& v) { v.foci.push_back(v.foci[0]); }},
      {"a focus elsewhere", [](Schedule&, Voice& v) { v.foci[3].x += 1.01 * alike_m; }}};
  for (const auto& [what, change] : changes)
    EXPECT_FALSE(alike(before, changed(change))) << what;
  EXPECT_TRUE(alike(before, before));
  EXPECT_TRUE(alike(before, changed([](Schedule&, Voice& v) { v.foci[3].x += 0.99 * alike_m; })));
  EXPECT_TRUE(alike(before, changed([](Schedule& s, Voice& v) { s.time_s = v.id = 7; }))) << "a finger is as another";
}

TEST(Heat, ShowsTheRatesOfAClassOfAfferents) {
  Played played;
  played.now.layout = std::make_shared<const array::Layout>(setup::load_posed_layout("openmpd"));
  played.move({0, 0, 0});
  played.now.tip = Vec3(0);
  Heat heat(ball(), played.now.air);
  Picture picture;
  SkinColour colour = SkinColour::pressure;
  const auto rests = [&] {
    heat.look(played.now, picture, colour);
    return !heat.busy();
  };
  const auto title = [&] { return picture.bars.empty() ? std::string() : picture.bars[0].title; };
  ASSERT_TRUE(test::begins(rests));
  EXPECT_CONTAINS(title(), "pressure");
  colour = SkinColour::pc;
  heat.look(played.now, picture, colour);
  EXPECT_TRUE(heat.busy()) << "rates are computed only if they are asked for";
  ASSERT_TRUE(test::begins(rests));
  EXPECT_EQ(heat.fault(), "");
  EXPECT_CONTAINS(title(), "PC: mean rate");
  const std::vector<drawing::Colour> pacinian = picture.skin->colours;
  for (const auto& [next, words] : {std::pair(SkinColour::ra, "RA: mean rate"), {SkinColour::pressure, "pressure"}}) {
    colour = next;
    EXPECT_TRUE(heat.look(played.now, picture, colour).skin) << words << " is there already";
    EXPECT_FALSE(heat.busy());
    EXPECT_CONTAINS(title(), words);
  }
  EXPECT_GT(difference(pacinian, picture), 0.1);
}

TEST(Sounds, TellEachFaultOnce) {
  Played played;
  played.now.tip = Vec3(0, 0, 0.1);
  array::Schedule odd = *played.now.schedule;
  odd.voices[0].modulation_hz = 123.457;  // repeats after an hour
  played.now.schedule = &odd;
  Sounds sounds({.select = "no such device"});
  sounds.set_finger(test::source_file("README.md").string());
  ViewState state;
  state.layers[Layer::heat].visible = state.layers[Layer::slice].visible = true;
  Picture picture;
  std::vector<std::string> told;
  double now_s = 0;
  const auto look = [&] {
    sounds.look(played.now, state, true, picture, now_s += 0.1);
    std::ranges::move(sounds.faults(), std::back_inserter(told));
  };
  const auto says = [&](const char* part) {
    return std::ranges::count_if(told, [&](const std::string& line) { return line.find(part) != std::string::npos; });
  };
  ASSERT_TRUE(test::begins([&] {
    look();
    return told.size() >= 3;
  })) << told.size();
  for (int i = 0; i < 50; ++i)
    look();
  EXPECT_EQ(told.size(), 3u);
  EXPECT_EQ(says("README.md"), 1) << "the finger";
  EXPECT_EQ(says("no such device"), 1) << "the plane";
  EXPECT_EQ(says("does not repeat"), 1) << "the spectrum";
  sounds.set_finger(test::source_file("LICENSE").string());
  ASSERT_TRUE(test::begins([&] {
    look();
    return says("LICENSE") > 0;
  })) << "another finger";
}

TEST(Spectra, AreThoseOfTheScheduleThatPlays) {
  Played played;
  Spectra spectra;
  double now_s = 0;
  ASSERT_TRUE(test::begins([&] { return spectra.look(played.now, now_s += 0.1); }));
  acoustics::SpectrumOptions options;
  const acoustics::ArrayField field(*played.now.layout, played.now.drive);
  options.field = &field;
  const auto expected = setup::spectra_of(*played.now.schedule, options);
  ASSERT_EQ(spectra.spectra().size(), 1u);
  ASSERT_EQ(spectra.spectra()[0].lines.size(), expected[0].lines.size());
  ASSERT_FALSE(expected[0].lines.empty());
  EXPECT_EQ(spectra.spectra()[0].field, acoustics::FocusKind::array);
  for (std::size_t i = 0; i < expected[0].lines.size(); ++i)
    EXPECT_EQ(spectra.spectra()[0].lines[i].around, expected[0].lines[i].around);
  EXPECT_FALSE(spectra.look(played.now, now_s += 1)) << "nothing else plays";
  played.now.schedule = nullptr;
  EXPECT_TRUE(spectra.look(played.now, now_s += 1));
  EXPECT_TRUE(spectra.spectra().empty());
}

/// After each move, the result is fresh once nothing is computed any more, and does not change after that. So it is if
/// the same plays again after silence.
template <typename Look, typename Busy>
void expect_newest_at_rest(Played& played, int moves, const Look& look, const Busy& busy) {
  for (int i = 0; i <= moves; ++i) {
    if (i < moves) {
      played.move({i * 1e-3, 0, 0.1});
    } else {
      const Sounding before = played.now;
      played.now.schedule = nullptr;
      played.now.plan = nullptr;
      played.now.slot = {};
      EXPECT_TRUE(look()) << "silence";
      EXPECT_FALSE(busy());
      played.now = before;
    }
    bool fresh = false;
    ASSERT_TRUE(test::begins(
        [&] {
          fresh = look() || fresh;
          return !busy();
        },
        without_rest));
    EXPECT_TRUE(fresh) << i;
    EXPECT_FALSE(look()) << i;
  }
}

TEST(Spectra, AtRestAreTheNewest) {
  Played played;
  Spectra spectra;
  double now_s = 0;
  expect_newest_at_rest(
      played, 40, [&] { return spectra.look(played.now, now_s += 1); }, [&] { return spectra.busy(); });
}

TEST(Spectra, OfAnotherSpotAreOthers) {
  Played played;
  played.now.layout = nullptr;
  played.now.spot_m = 5e-3;
  Spectra spectra;
  double now_s = 0;
  const auto strongest = [&] {
    EXPECT_TRUE(test::begins([&] { return spectra.look(played.now, now_s += 1); }));
    return spectra.spectra().at(0).lines.at(0).around;
  };
  const auto narrow = strongest();
  played.now.spot_m = 10e-3;
  EXPECT_NE(strongest(), narrow);
}

TEST(SlicePreview, AtRestIsTheNewest) {
  Played played({0, 0, 0.1}, 16);
  SlicePreview slices({});
  Picture picture;
  double now_s = 0;
  expect_newest_at_rest(
      played, 8, [&] { return slices.look(played.now, {}, picture, now_s += 1).marks; }, [&] { return slices.busy(); });
}

TEST(Sounding, ATipIsTheLowestSkinAroundTheMiddle) {
  touch::Touch touch;
  EXPECT_FALSE(tip_of(touch));
  touch.fingers.resize(1);
  touch.finger_count = 1;
  touch.fingers[0].section.centroid = {0.01f, 0, 0};
  touch.contacts.push_back({.position = {0.012f, -0.001f, 0}});
  touch.deep.push_back({.position = {0.01f, -0.003f, 0.001f}});
  touch.deep.push_back({.position = {0.05f, -0.009f, 0}});  // another finger's
  const std::optional<Vec3> tip = tip_of(touch);
  ASSERT_TRUE(tip);
  EXPECT_LT(glm::distance(*tip, Vec3(0.01, -0.003, 0)), 1e-6);
}

/// A plane in front of the eye, 40 mm wide, in a picture of 800 x 600.
class SliceHands : public testing::Test {
 protected:
  SliceHands() {
    sight.viewpoint.azimuth = sight.viewpoint.elevation = 0;
    sight.viewpoint.distance = 0.3;
    slice.size_m = {0.04, 0.04};
  }
  bool send(Kind kind, const Vec2& at) { return hand.handle({.kind = kind, .x = at.x, .y = at.y}, sight, slice); }
  Vec2 pixels(const Vec3& world) const {
    const Projected p = project(projection(sight.viewpoint, sight.width, sight.height), world);
    return {p.x, p.y};
  }
  Sight sight{.viewpoint = {}, .width = 800, .height = 600, .ratio = 1};
  SliceState slice;
  SliceHand hand;
};

TEST_F(SliceHands, ThePlaneGoesAlongItsNormalWithThePointer) {
  slice.T_world_slice = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};  // level: its normal is up
  const Vec2 middle = pixels({0, 0, 0});
  EXPECT_FALSE(send(Kind::press, middle + Vec2(60, 60))) << "no handle is there";
  ASSERT_TRUE(send(Kind::press, middle));
  EXPECT_TRUE(hand.dragging());
  const Vec2 to = pixels({0, 0.02, 0});
  ASSERT_TRUE(send(Kind::move, to));
  EXPECT_TRUE(send(Kind::release, to));
  EXPECT_NEAR(slice.T_world_slice[3].y, 0.02, 1e-4);
  EXPECT_NEAR(slice.T_world_slice[3].x, 0, 1e-9);
  EXPECT_FALSE(send(Kind::move, middle)) << "let go of";
}

TEST_F(SliceHands, EscapeLetsGoOfItWhereItWas) {
  sight.viewpoint.elevation = 1.2;
  const SliceState before = slice;
  const Vec2 end = pixels(place_of(SliceHandle::x_end, slice));
  const WindowEvent escape{.kind = Kind::key, .key = Key::escape};
  EXPECT_FALSE(hand.handle(escape, sight, slice)) << "nothing is dragged";
  ASSERT_TRUE(send(Kind::press, end));
  ASSERT_TRUE(send(Kind::move, end + Vec2(0, 40)));
  EXPECT_NE(slice, before);
  EXPECT_TRUE(hand.handle(escape, sight, slice));
  EXPECT_EQ(slice, before);
  EXPECT_FALSE(hand.dragging());
}

TEST_F(SliceHands, AnEndTurnsItAboutTheOtherAxis) {
  sight.viewpoint.elevation = 1.2;  // from above, so that the end visibly moves around
  const Vec2 end = pixels(place_of(SliceHandle::x_end, slice));
  ASSERT_TRUE(send(Kind::press, end));
  for (int i = 1; i <= 20; ++i)
    ASSERT_TRUE(send(Kind::move, end + Vec2(0, 4.0 * i)));
  const Vec3 x(slice.T_world_slice[0]), y(slice.T_world_slice[1]), at(slice.T_world_slice[3]);
  EXPECT_LT(glm::distance(y, Vec3(0, 1, 0)), 1e-9);
  EXPECT_LT(glm::length(at), 1e-9);
  EXPECT_GT(x.z, 0.3) << "towards the eye, as the pointer went down";
  EXPECT_NEAR(glm::length(x), 1, 1e-9);
  EXPECT_NEAR(pixels(place_of(SliceHandle::x_end, slice)).y, end.y + 80, 20) << "its way is a circle";
}

TEST_F(SliceHands, SeenAlongItsNormalNothingJumps) {
  const Vec2 middle = pixels({0, 0, 0});  // its normal points at the eye
  ASSERT_TRUE(send(Kind::press, middle));
  ASSERT_TRUE(send(Kind::move, middle + Vec2(3, 5)));
  EXPECT_LT(glm::length(Vec3(slice.T_world_slice[3])), 0.01);
}

}  // namespace
}  // namespace palpa::viewer
