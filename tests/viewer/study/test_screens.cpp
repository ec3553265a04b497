// The pictures of a study's windows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "viewer/study/screens.hpp"

namespace palpa::viewer {
namespace {

ParticipantView question(std::size_t answers) {
  ParticipantView view{.screen = study::Screen::question, .text = "Which shape was it?"};
  for (std::size_t i = 0; i < answers; ++i)
    view.buttons.push_back("answer " + std::to_string(i));
  return view;
}

TEST(Screens, ButtonsAreApartAndInside) {
  for (const auto& [width, height] : {std::pair(1280u, 800u), std::pair(640u, 480u), std::pair(3840u, 2160u)}) {
    for (const std::size_t answers : {2, 4, 5, 7, 16}) {
      const auto places = button_places(question(answers), width, height);
      ASSERT_EQ(places.size(), answers);
      for (std::size_t i = 0; i < answers; ++i) {
        const ButtonPlace& a = places[i];
        EXPECT_LT(a.right, width);
        EXPECT_LT(a.bottom, height);
        EXPECT_GT(a.right - a.left, width / 16) << answers;
        EXPECT_GT(a.bottom - a.top, height / 20) << answers;
        EXPECT_EQ(button_at(places, (a.left + a.right) / 2.0, (a.top + a.bottom) / 2.0), i);
        for (std::size_t k = 0; k < i; ++k) {
          const ButtonPlace& b = places[k];
          EXPECT_TRUE(a.left > b.right || b.left > a.right || a.top > b.bottom || b.top > a.bottom) << i << " " << k;
        }
      }
      EXPECT_FALSE(button_at(places, 1, 1));
    }
  }
}

/// Up to four in one row, up to eight in two, and more in up to four.
TEST(Screens, ButtonsStandInRows) {
  const std::vector<std::size_t> in_a_row{1, 2, 3, 4, 3, 3, 4, 4, 3, 3, 3, 3, 4, 4, 4, 4};
  std::vector<std::size_t> found;
  for (std::size_t answers = 1; answers <= in_a_row.size(); ++answers) {
    // Row by row from the left: the second row is the first one's next.
    const auto places = button_places(question(answers), 1280, 800);
    std::size_t columns = 1;
    while (columns < answers && places[columns].left > places[columns - 1].left)
      ++columns;
    found.push_back(columns);
    for (std::size_t i = columns; i < answers; ++i) {
      EXPECT_EQ(places[i].left, places[i - columns].left) << answers << " " << i;
      EXPECT_GT(places[i].top, places[i - columns].bottom) << answers << " " << i;
    }
  }
  EXPECT_EQ(found, in_a_row);
}

TEST(Screens, KeysAreThoseOfTheButtons) {
  std::set<std::string> keys;
  for (std::size_t i = 0; i < 16; ++i) {
    keys.insert(button_key(i));
    EXPECT_EQ(button_of_key(button_key(i).front()), i);
  }
  EXPECT_EQ(keys.size(), 16u);
  EXPECT_FALSE(button_of_key(' '));
  EXPECT_FALSE(button_of_key('0'));
}

std::size_t lit(const drawing::Pixels& picture) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
    count += picture.rgba[i] > 160 ? 1 : 0;
  return count;
}

TEST(Screens, ShowTheirText) {
  const ParticipantView empty;
  ParticipantView words = empty;
  words.text = "Move your finger up and down from the marker. Afterwards, say which shape it was.";
  EXPECT_EQ(lit(draw(empty, 800, 500)), 0u);
  const std::size_t once = lit(draw(words, 800, 500));
  EXPECT_GT(once, 500u);
  EXPECT_EQ(draw(words, 800, 500).rgba, draw(words, 800, 500).rgba);
  // Over a scene, only the top changes.
  drawing::Pixels scene{800, 500, std::vector<std::uint8_t>(800 * 500 * 4, 200)};
  const drawing::Pixels over = draw(words, 800, 500, &scene);
  EXPECT_NE(over.at(400, 5)[0], 200);
  EXPECT_EQ(over.at(400, 480)[0], 200);
}

/// Rows of the scene that a text has changed.
std::size_t covered_rows(const drawing::Pixels& scene, const drawing::Pixels& over) {
  std::size_t rows = 0;
  for (std::uint32_t y = 0; y < scene.height; ++y)
    rows += std::equal(scene.at(0, y), scene.at(0, y) + std::size_t{4} * scene.width, over.at(0, y)) ? 0 : 1;
  return rows;
}

TEST(Screens, LongTextsLeaveTheMarkerVisible) {
  drawing::Pixels scene{1280, 720, std::vector<std::uint8_t>(std::size_t{1280} * 720 * 4, 30)};
  constexpr std::size_t marker = 240;
  for (std::size_t y = marker; y < marker + 12; ++y)
    std::fill_n(scene.rgba.begin() + static_cast<std::ptrdiff_t>(4 * (y * 1280 + 620)), 4 * 40, std::uint8_t{220});
  std::string words;
  for (const std::size_t sentences : {1, 6, 8, 14}) {
    words.clear();
    for (std::size_t i = 0; i < sentences; ++i)
      words += "This is one sentence of the instruction to you. ";
    const ParticipantView view{.screen = study::Screen::ready, .text = words};
    const drawing::Pixels over = draw(view, 1280, 720, &scene);
    EXPECT_LE(covered_rows(scene, over), marker) << sentences;
    EXPECT_GT(lit(over), 40u * 12 + 300) << "and the text is there";
  }
}

/// A consent page may be long.
TEST(Screens, LongTextsEndAboveTheButtons) {
  ParticipantView view = question(2);
  view.text.clear();
  for (int i = 0; i < 14; ++i)
    view.text += "This is one sentence of the information to you. ";
  const ButtonPlace place = button_places(view, 1280, 720)[0];
  ParticipantView buttons = view;
  buttons.text.clear();
  const drawing::Pixels with = draw(view, 1280, 720), without = draw(buttons, 1280, 720);
  for (std::uint32_t y = place.top; y < 720; ++y)
    ASSERT_TRUE(std::equal(with.at(0, y), with.at(0, y) + 4 * 1280, without.at(0, y))) << y;
}

TEST(Screens, KeysStandBesideTheirLabels) {
  for (const std::size_t answers : {2, 12, 16}) {
    ParticipantView view = question(answers), keys = view;
    const std::string label = "pyramid, gypsy";
    view.buttons.assign(answers, label);
    keys.buttons.assign(answers, "");
    const drawing::Pixels both = draw(view, 400, 300), only_keys = draw(keys, 400, 300);
    // The boxes around the key and around what the label adds.
    const ButtonPlace place = button_places(view, 400, 300)[answers - 1];
    struct Box {
      std::uint32_t left = 400, right = 0, top = 300, bottom = 0;
      void add(std::uint32_t x, std::uint32_t y) {
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
      }
    } of_key, of_label;
    for (std::uint32_t y = place.top + 2; y + 2 < place.bottom; ++y) {
      for (std::uint32_t x = place.left + 2; x + 2 < place.right; ++x) {
        if (only_keys.at(x, y)[0] > 100) of_key.add(x, y);
        if (both.at(x, y)[0] > only_keys.at(x, y)[0] + 50) of_label.add(x, y);
      }
    }
    ASSERT_LT(of_key.left, of_key.right);
    ASSERT_LT(of_label.left, of_label.right);
    EXPECT_TRUE(of_key.right < of_label.left || of_label.bottom < of_key.top) << answers;
  }
}

TEST(Screens, TheExperimenterSeesWhetherItSounds) {
  ExperimenterView view{.title = "Study", .state = "touch", .lines = {{"method", "cross-section"}}};
  view.buttons = {{Command::pause, "pause", "P"}, {Command::stop, "stop", "Q"}};
  ExperimenterView sounding = view;
  sounding.sounds = true;
  const auto red = [](const drawing::Pixels& picture) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      count += picture.rgba[i] > 200 && picture.rgba[i + 1] < 120 ? 1 : 0;
    return count;
  };
  EXPECT_EQ(red(draw(view, 900, 620)), 0u);
  EXPECT_GT(red(draw(sounding, 900, 620)), 1000u);
  ExperimenterView may_sound = view;
  may_sound.may_sound = true;
  EXPECT_GT(red(draw(may_sound, 900, 620)), 1000u);
  EXPECT_NE(draw(may_sound, 900, 620).rgba, draw(sounding, 900, 620).rgba);
  const auto places = button_places(view, 900, 620);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_LT(places[0].right, places[1].left);
}

}  // namespace
}  // namespace palpa::viewer
