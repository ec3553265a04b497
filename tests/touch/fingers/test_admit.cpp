// Which clusters are fingers, and whose skin is what is none: rules on tables that are made by hand.
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "touch/fingers/admit.hpp"
#include "touch/fingers/members.hpp"

namespace palpa::touch {
namespace {

constexpr std::uint32_t side = 120;  ///< pixels
constexpr float width_m = 25e-3F;
constexpr std::uint32_t frame_us = 11111;

/// A camera that sees a wall at 0.5 m, frame after frame. A patch of the wall is a cluster.
class Frames {
 public:
  HysteresisRules rules;

  void begin() {
    touch_ = {};
    for (FingerSkin& skin : skins_)
      skin = {};
  }
  /// A square of `edge` x `edge` pixels of 0.83 mm.
  void add(std::uint32_t u, std::uint32_t v, std::uint32_t edge, float depth_m = 1e-3F) {
    Finger finger;
    for (std::uint32_t y = v; y < v + edge; ++y) {
      for (std::uint32_t x = u; x < u + edge; ++x) {
        const glm::vec2 ray = tables_.rays[std::size_t{y} * tables_.cameras[0].pitch + x];
        finger.contacts.push_back(static_cast<std::uint32_t>(touch_.contacts.size()));
        touch_.contacts.push_back({y * side + x, 0, depth_m, {0.5F * ray.x, 0.5F * ray.y, 0.5F}});
      }
    }
    finger.contact_count = edge * edge;
    touch_.fingers.push_back(finger);
    ++touch_.finger_count;
  }
  /// Contacts of the fingers of this frame, which are the known ones of the next.
  std::vector<std::uint32_t> admit() {
    const Sight sight{cameras_, tables_, images_};
    const Known known{frame_us, rules, has_before_ ? table_.get() : nullptr, width_m};
    for (std::uint32_t f = 0; f < touch_.finger_count; ++f)
      skins_[f] = look_at(sight, known, touch_, touch_.fingers[f]);
    const Continuations continuations = admit_fingers(sight, parameters_, known, *table_, touch_, skins_);
    std::vector<std::uint32_t> contacts;
    table_->count = touch_.finger_count;
    for (std::uint32_t f = 0; f < touch_.finger_count; ++f) {
      const Finger& finger = touch_.fingers[f];
      EXPECT_EQ(finger.contact_count, finger.contacts.size());
      contacts.push_back(finger.contact_count);
      KnownFinger& kept = table_->fingers[f];
      kept = {.insides = {}, .continuation = {.fall = next_fall(continuations[f].fall, finger.contact_count)}};
      for (const SkinSample& sample : skins_[f].samples) {
        const glm::vec3 inside = inside_of(sample, width_m);
        kept.low = kept.insides.empty() ? inside : glm::min(kept.low, inside);
        kept.high = kept.insides.empty() ? inside : glm::max(kept.high, inside);
        kept.insides.push_back(inside);
      }
    }
    has_before_ = true;
    return contacts;
  }
  std::vector<std::uint32_t> admit_nothing() {
    begin();
    return admit();
  }

 private:
  sensing::Camera camera_{
      .width = side, .height = side, .fx = 600, .fy = 600, .cx = 60, .cy = 60, .depth_unit_m = 1e-4};
  sensing::RayTables tables_ = sensing::make_rays({&camera_, 1});
  std::vector<SightCamera> cameras_ = sight_cameras({&camera_, 1}, tables_);
  std::vector<sensing::DepthFrame> images_{{std::vector<std::uint16_t>(std::size_t{side} * side, 5000)}};
  FingerOptions parameters_{.min_points = 16};
  std::unique_ptr<KnownFingers> table_ = std::make_unique<KnownFingers>();
  bool has_before_ = false;
  Touch touch_;
  FingerSkins skins_{max_fingers};
};

using Contacts = std::vector<std::uint32_t>;

TEST(Admit, HalfOfMinPointsIsForTheHeirOnly) {
  Frames frames;
  frames.rules.whole = false;
  frames.begin();
  frames.add(40, 40, 12);
  ASSERT_EQ(frames.admit(), Contacts{144});
  // Two clusters where the finger was. Either would go on by itself.
  frames.begin();
  frames.add(40, 40, 3);
  EXPECT_EQ(frames.admit(), Contacts{9});
  frames.begin();
  frames.add(38, 40, 6);
  frames.add(48, 40, 3);
  EXPECT_EQ(frames.admit(), Contacts{36}) << "9 contacts are fewer than 16";
}

TEST(Admit, SkinThatBecomesNoFingerIsTheHeirs) {
  Frames frames;
  frames.begin();
  frames.add(40, 40, 12);
  frames.admit();
  frames.begin();
  frames.add(48, 40, 3);
  frames.add(38, 40, 6);
  EXPECT_EQ(frames.admit(), Contacts{36 + 9});
  // What is far away is nobody's.
  frames.begin();
  frames.add(38, 40, 6);
  frames.add(100, 100, 3);
  EXPECT_EQ(frames.admit(), Contacts{36});
}

TEST(Admit, SkinOfNobodyIsTheHeirsIfItIsWithinTheFingerGap) {
  for (const auto& [island, contacts] : {std::pair{44U, Contacts{900 + 400}}, std::pair{60U, Contacts{900}}}) {
    Frames frames;
    frames.begin();
    frames.add(10, 40, 30);
    ASSERT_EQ(frames.admit(), Contacts{900});
    frames.begin();
    frames.add(10, 40, 30);
    frames.add(island, 45, 20);
    EXPECT_EQ(frames.admit(), contacts) << "it begins " << 0.83 * (island - 39) << " mm beside";
  }
}

TEST(Admit, AnIslandThatIsMissingForAFrameDoesNotBeginAgain) {
  const auto frames_until_born = [](bool gaps) {
    Frames frames;
    frames.begin();
    frames.add(20, 40, 12);
    frames.admit();
    for (int k = 1; k < 30; ++k) {
      frames.begin();
      frames.add(20, 40, 12);
      if (!gaps || k % 4 != 0) frames.add(80, 40, 5);
      if (frames.admit().size() == 2) return k;
    }
    return 30;
  };
  EXPECT_EQ(frames_until_born(false), 6) << "50 ms after it was first seen";
  EXPECT_EQ(frames_until_born(true), 10) << "a frame without it counts against it";
}

TEST(Admit, WhereAFingerHasEndedOnlySkinThatPressesBeginsAtOnce) {
  Frames frames;
  frames.begin();
  frames.add(40, 40, 12, 0.2e-3F);
  EXPECT_EQ(frames.admit(), Contacts{144}) << "a first touch may be shallow";
  EXPECT_EQ(frames.admit_nothing(), Contacts{});
  frames.begin();
  frames.add(40, 40, 12, 0.2e-3F);
  EXPECT_EQ(frames.admit(), Contacts{});
  frames.begin();
  frames.add(90, 90, 12, 0.2e-3F);
  EXPECT_EQ(frames.admit(), Contacts{144}) << "another place";
  frames.admit_nothing();
  frames.begin();
  frames.add(40, 40, 12, 0.4e-3F);
  EXPECT_EQ(frames.admit(), Contacts{144});
  // It has been there for long enough.
  frames.admit_nothing();
  int waited = 0;
  for (bool born = false; !born && waited < 20; ++waited) {
    frames.begin();
    frames.add(40, 40, 12, 0.2e-3F);
    born = !frames.admit().empty();
  }
  EXPECT_EQ(waited, 6);
  // Half a second later, it is a first touch again.
  for (int k = 0; k < 46; ++k)
    frames.admit_nothing();
  frames.begin();
  frames.add(40, 40, 12, 0.2e-3F);
  EXPECT_EQ(frames.admit(), Contacts{144});
}

// ---- contacts that join or leave are no motion ----

std::vector<glm::vec3> patch(const glm::vec3& from, int columns, int rows) {
  std::vector<glm::vec3> places;
  for (int x = 0; x < columns; ++x) {
    for (int z = 0; z < rows; ++z)
      places.push_back({from.x + 1e-3F * static_cast<float>(x), from.y, from.z + 1e-3F * static_cast<float>(z)});
  }
  return places;
}

TEST(Members, ThatJoinOrLeaveMoveTheCentroid) {
  const std::vector<glm::vec3> before = patch({0, 0, 0}, 12, 8);
  std::vector<glm::vec3> now = patch({1e-3F, 0, 0}, 12, 8), more = patch({30e-3F, 0, 0}, 6, 8);
  now.insert(now.end(), more.begin(), more.end());
  // Of 144 contacts, 48 have their middle 26 mm further on than the others.
  const glm::vec3 joined = moved_by_members(before, now, {0, 0, 0});
  EXPECT_NEAR(joined.x, 26e-3 / 3, 1e-5);
  EXPECT_NEAR(joined.y, 0, 1e-7);
  EXPECT_NEAR(joined.z, 0, 1e-7);
  EXPECT_NEAR(moved_by_members(now, before, {0, 0, 0}).x, -26e-3 / 3, 1e-5);
}

TEST(Members, ThatStayMoveTheSkin) {
  const std::vector<glm::vec3> before = patch({0, 0, 0}, 12, 8);
  for (const float way : {0.0F, 2e-3F, 5e-3F}) {
    EXPECT_EQ(moved_by_members(before, patch({way, 0, 0}, 12, 8), {0, 0, 0}).x, 0) << way;
    EXPECT_EQ(moved_by_members(before, patch({0.1F + way, 0, 0}, 12, 8), {0.1F, 0, 0}).x, 0) << way;
  }
  EXPECT_EQ(moved_by_members(before, patch({9e-3F, 0, 0}, 12, 8), {0, 0, 0}).x, 0) << "faster than expected";
  EXPECT_EQ(moved_by_members(before, patch({0.1F, 0, 0}, 12, 8), {0, 0, 0}).x, 0) << "nothing is common";
  EXPECT_EQ(moved_by_members(before, {}, {0, 0, 0}).x, 0);
}

}  // namespace
}  // namespace palpa::touch
