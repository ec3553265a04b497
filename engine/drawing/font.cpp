#include "drawing/font.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numbers>

namespace palpa::drawing {
namespace {

// Units: capitals and digits are 7 high, small letters 5, descenders reach -2; y up, baseline 0. Commands:
//   m x y              move the pen to x y and start a line (alone: a dot)
//   l x y              a line to x y
//   q cx cy x y        a quadratic curve
//   a cx cy rx ry s e  an elliptic arc from s to e degrees (0 right, 90 up), with the pen lifted before it
//   A ...              the same, joined to the previous stroke
struct Drawing {
  std::uint32_t code;
  const char* commands;
};
constexpr double cap_height = 7.0, gap = 1.55, space_width = 2.2;
constexpr std::uint32_t box = 0xfffd;

constexpr Drawing drawings[] = {
    {'0', "a 2.5 3.5 2.15 3.5 90 450"},
    {'1', "m 0.9 5.6 l 2.8 7 l 2.8 0 m 2.8 0"},
    {'2', "a 2.45 4.95 1.95 2.05 165 -35 l 0.5 0 l 4.6 0"},
    {'3', "a 2.4 5.25 1.75 1.75 150 -90 A 2.4 1.75 2.1 1.75 90 -150"},
    {'4', "m 3.6 0 l 3.6 7 l 0.3 2 l 4.8 2"},
    {'5', "m 4.3 7 l 1 7 l 0.7 3.8 A 2.4 2.25 2.2 2.25 130 -145"},
    {'6', "m 3.8 7 q 0.4 5.2 0.4 2.2 A 2.5 2.2 2.1 2.2 180 540"},
    {'7', "m 0.4 7 l 4.6 7 l 1.8 0"},
    {'8', "a 2.5 5.3 1.75 1.7 90 450 a 2.5 1.8 2.1 1.8 90 450"},
    {'9', "m 1.2 0 q 4.6 1.8 4.6 4.8 A 2.5 4.8 2.1 2.2 0 360"},
    {'a', "a 2.45 2.5 2.05 2.5 90 450 m 4.5 5 l 4.5 0"},
    {'b', "m 0.4 7 l 0.4 0 m 0.4 2.5 A 2.45 2.5 2.05 2.5 180 540"},
    {'c', "a 2.45 2.5 2.05 2.5 48 312"},
    {'d', "a 2.45 2.5 2.05 2.5 90 450 m 4.5 7 l 4.5 0"},
    {'e', "m 0.4 2.5 l 4.5 2.5 A 2.45 2.5 2.05 2.5 0 318"},
    {'f', "a 2.7 5.6 1.3 1.4 80 180 l 1.4 0 m 0.2 4.8 l 2.9 4.8"},
    {'g', "a 2.45 2.5 2.05 2.5 90 450 m 4.5 5 l 4.5 -0.2 A 2.5 -0.2 2 1.8 0 -150"},
    {'h', "m 0.4 7 l 0.4 0 m 0.4 3 A 2.3 3 1.9 2 180 0 l 4.2 0"},
    {'i', "m 0.4 5 l 0.4 0 m 0.4 6.9"},
    {'j', "m 1.2 5 l 1.2 -0.8 A 0.1 -0.8 1.1 1.2 0 -85 m 1.2 6.9"},
    {'k', "m 0.4 7 l 0.4 0 m 3.8 5 l 0.4 1.8 m 1.6 2.9 l 4 0"},
    {'l', "m 0.4 7 l 0.4 0"},
    {'m', "m 0.4 5 l 0.4 0 m 0.4 3.3 A 2 3.3 1.6 1.7 180 0 l 3.6 0 m 3.6 3.3 A 5.2 3.3 1.6 1.7 180 0 l 6.8 0"},
    {'n', "m 0.4 5 l 0.4 0 m 0.4 3 A 2.3 3 1.9 2 180 0 l 4.2 0"},
    {'o', "a 2.45 2.5 2.05 2.5 90 450"},
    {'p', "m 0.4 5 l 0.4 -2 m 0.4 2.5 A 2.45 2.5 2.05 2.5 180 540"},
    {'q', "a 2.45 2.5 2.05 2.5 90 450 m 4.5 5 l 4.5 -2"},
    {'r', "m 0.4 5 l 0.4 0 m 0.4 3 A 2.1 3 1.7 2 180 65"},
    {'s', "a 1.9 3.75 1.4 1.25 35 270 A 1.9 1.25 1.5 1.25 90 -148"},
    {'t', "m 1.4 6.6 l 1.4 1.3 A 2.6 1.3 1.2 1.3 180 275 m 0.2 4.8 l 2.9 4.8"},
    {'u', "m 0.4 5 l 0.4 2 A 2.3 2 1.9 2 180 360 m 4.2 5 l 4.2 0"},
    {'v', "m 0.2 5 l 2.2 0 l 4.2 5"},
    {'w', "m 0.2 5 l 1.8 0 l 3.4 4.7 l 5 0 l 6.6 5"},
    {'x', "m 0.3 5 l 4.1 0 m 4.1 5 l 0.3 0"},
    {'y', "m 0.2 5 l 2.3 0 m 4.3 5 l 1.5 -2"},
    {'z', "m 0.4 5 l 4 5 l 0.3 0 l 4.1 0"},
    {'A', "m 0.2 0 l 2.9 7 l 5.6 0 m 1.15 2.4 l 4.65 2.4"},
    {'B', "m 0.5 0 l 0.5 7 l 2.6 7 A 2.6 5.3 1.7 1.7 90 -90 l 0.5 3.6 m 2.6 3.6 A 2.8 1.8 2 1.8 90 -90 l 0.5 0"},
    {'C', "a 3.5 3.5 3.1 3.5 48 312"},
    {'D', "m 0.5 0 l 0.5 7 l 2 7 A 2 3.5 3.3 3.5 90 -90 l 0.5 0"},
    {'E', "m 4.2 7 l 0.5 7 l 0.5 0 l 4.2 0 m 0.5 3.6 l 3.8 3.6"},
    {'F', "m 4.2 7 l 0.5 7 l 0.5 0 m 0.5 3.6 l 3.8 3.6"},
    {'G', "a 3.5 3.5 3.1 3.5 48 360 l 4 3.5"},
    {'H', "m 0.5 0 l 0.5 7 m 4.9 0 l 4.9 7 m 0.5 3.6 l 4.9 3.6"},
    {'I', "m 0.5 0 l 0.5 7"},
    {'J', "m 2.9 7 l 2.9 1.7 A 1.5 1.7 1.4 1.7 0 -155"},
    {'K', "m 0.5 0 l 0.5 7 m 4.6 7 l 0.5 2.6 m 1.9 4.1 l 4.8 0"},
    {'L', "m 0.5 7 l 0.5 0 l 4 0"},
    {'M', "m 0.5 0 l 0.5 7 l 3.2 2 l 5.9 7 l 5.9 0"},
    {'N', "m 0.5 0 l 0.5 7 l 4.9 0 l 4.9 7"},
    {'O', "a 3.6 3.5 3.2 3.5 90 450"},
    {'P', "m 0.5 0 l 0.5 7 l 2.7 7 A 2.7 5.1 1.9 1.9 90 -90 l 0.5 3.2"},
    {'Q', "a 3.6 3.5 3.2 3.5 90 450 m 4.4 1.7 l 6.6 -0.4"},
    {'R', "m 0.5 0 l 0.5 7 l 2.7 7 A 2.7 5.1 1.9 1.9 90 -90 l 0.5 3.2 m 2.6 3.2 l 4.8 0"},
    {'S', "a 2.4 5.25 1.8 1.75 35 270 A 2.4 1.75 2 1.75 90 -150"},
    {'T', "m 0.2 7 l 5 7 m 2.6 7 l 2.6 0"},
    {'U', "m 0.5 7 l 0.5 2.2 A 2.7 2.2 2.2 2.2 180 360 l 4.9 7"},
    {'V', "m 0.2 7 l 2.8 0 l 5.4 7"},
    {'W', "m 0.2 7 l 2 0 l 3.9 6.4 l 5.8 0 l 7.6 7"},
    {'X', "m 0.3 7 l 5 0 m 5 7 l 0.3 0"},
    {'Y', "m 0.2 7 l 2.6 3.4 l 5 7 m 2.6 3.4 l 2.6 0"},
    {'Z', "m 0.4 7 l 4.8 7 l 0.3 0 l 4.9 0"},
    {'.', "m 0.4 0.1"},
    {',', "m 0.8 0.3 l 0.2 -1.3"},
    {':', "m 0.4 0.1 m 0.4 4"},
    {';', "m 0.8 0.3 l 0.2 -1.3 m 0.8 4"},
    {'!', "m 0.4 7 l 0.4 2 m 0.4 0.1"},
    {'?', "a 2 5.2 1.7 1.8 165 -60 q 2 3 2 2 m 2 0.1"},
    {'\'', "m 0.4 7 l 0.4 5.2"},
    {'"', "m 0.4 7 l 0.4 5.2 m 1.8 7 l 1.8 5.2"},
    {'-', "m 0.4 2.6 l 2.6 2.6"},
    {'_', "m 0 -1 l 4.4 -1"},
    {'+', "m 0.3 2.8 l 4.3 2.8 m 2.3 0.8 l 2.3 4.8"},
    {'=', "m 0.3 3.7 l 4.3 3.7 m 0.3 1.8 l 4.3 1.8"},
    {'*', "m 1.8 3.4 l 1.8 7 m 0.2 4.3 l 3.4 6.1 m 3.4 4.3 l 0.2 6.1"},
    {'/', "m 0.2 -1 l 3.2 7.4"},
    {'\\', "m 3.2 -1 l 0.2 7.4"},
    {'|', "m 0.4 -1.5 l 0.4 7.5"},
    {'(', "a 3.4 3 3 5 130 230"},
    {')', "a -1.5 3 3 5 50 -50"},
    {'[', "m 1.8 7.6 l 0.4 7.6 l 0.4 -1.4 l 1.8 -1.4"},
    {']', "m 0.2 7.6 l 1.6 7.6 l 1.6 -1.4 l 0.2 -1.4"},
    {'{', "m 2 7.6 q 1 7.6 1 6 l 1 4.4 q 1 3.1 0.1 3.1 q 1 3.1 1 1.8 l 1 0.2 q 1 -1.4 2 -1.4"},
    {'}', "m 0.1 7.6 q 1.1 7.6 1.1 6 l 1.1 4.4 q 1.1 3.1 2 3.1 q 1.1 3.1 1.1 1.8 l 1.1 0.2 q 1.1 -1.4 0.1 -1.4"},
    {'<', "m 4 4.8 l 0.4 2.8 l 4 0.8"},
    {'>', "m 0.4 4.8 l 4 2.8 l 0.4 0.8"},
    {'#', "m 1.6 0 l 2.4 7 m 3.6 0 l 4.4 7 m 0.4 2.3 l 5 2.3 m 0.7 4.7 l 5.3 4.7"},
    {'%', "a 1.5 5.6 1.2 1.4 90 450 a 5.3 1.4 1.2 1.4 90 450 m 5.2 7 l 1.6 0"},
    {'&',
     "m 5 0 l 1.2 4.6 q 0.6 5.4 1 6.2 q 1.5 7 2.2 7 q 3.6 7 3.5 5.6 q 3.3 4.4 1.6 3.5 q 0.4 2.7 0.4 1.8 "
     "q 0.5 0 2.4 0 q 4.6 0 4.9 3"},
    {'@', "a 3.5 2.5 1.4 1.6 90 450 m 4.9 4.1 l 4.9 1.8 q 5.1 0.9 5.8 0.9 q 6.7 1.2 6.7 3 A 3.6 2.8 3.1 3.6 0 300"},
    {'$', "a 2.3 4.9 1.7 1.4 35 270 A 2.3 2.1 1.9 1.4 90 -150 m 2.3 7.3 l 2.3 -0.3"},
    {'~', "m 0.3 2.3 q 1.3 3.8 2.3 2.8 q 3.3 1.8 4.3 3.3"},
    {'^', "m 0.4 5 l 1.9 7 l 3.4 5"},
    {'`', "m 0.4 7 l 1.4 5.8"},
    {0xb0, "a 1.3 6 1 1 90 450"},                                                                        // degree
    {0xb5, "m 0.4 5 l 0.4 -2 m 0.4 2 A 2.2 2 1.8 2 180 360 m 4 5 l 4 0"},                                // micro
    {0xb7, "m 0.6 2.8"},                                                                                 // middle dot
    {0xd7, "m 0.6 1.2 l 3.8 4.4 m 0.6 4.4 l 3.8 1.2"},                                                   // times
    {0x3c0, "m 0.2 4.8 l 5 4.8 m 1.5 4.8 l 1.2 0 m 3.7 4.8 l 3.7 1 q 3.8 0 4.8 0.1"},                    // pi
    {0x2013, "m 0.3 2.6 l 4 2.6"},                                                                       // en dash
    {0x2212, "m 0.3 2.8 l 4.3 2.8"},                                                                     // minus
    {0x2192, "m 0.3 2.8 l 5.3 2.8 m 3.6 4.5 l 5.3 2.8 l 3.6 1.1"},                                       // arrow
    {0xdf, "m 0.4 0 l 0.4 5.4 A 2.1 5.4 1.7 1.6 180 -90 m 1.9 3.8 l 2.1 3.8 A 2.2 1.9 2 1.9 90 -120"},   // sharp s
    {0xe6, "a 2.45 2.5 2.05 2.5 90 450 m 4.5 5 l 4.5 0 m 4.5 2.5 l 8.6 2.5 A 6.55 2.5 2.05 2.5 0 318"},  // ae
    {0xc6, "m 0.2 0 l 3.6 7 l 7.4 7 m 3.9 7 l 3.9 0 l 7.4 0 m 1.4 2.4 l 3.9 2.4 m 3.9 3.6 l 7 3.6"},     // AE
    {0x153, "a 2.45 2.5 2.05 2.5 90 450 m 4.5 2.5 l 8.6 2.5 A 6.55 2.5 2.05 2.5 0 318"},                 // oe
    {0x152, "a 3.6 3.5 3.2 3.5 90 270 l 7.6 0 m 3.6 7 l 7.6 7 m 4.2 7 l 4.2 0 m 4.2 3.6 l 7.2 3.6"},     // OE
    {0xf0, "a 2.45 2.2 2.05 2.2 90 450 m 1.1 7 q 4.5 5.6 4.5 2.2 m 1.2 5.2 l 3.8 6.7"},                  // eth
    {0xd0, "m 1 0 l 1 7 l 2.5 7 A 2.5 3.5 3.3 3.5 90 -90 l 1 0 m 0.1 3.6 l 2.6 3.6"},                    // Eth
    {0xfe, "m 0.4 7 l 0.4 -2 m 0.4 2.5 A 2.45 2.5 2.05 2.5 180 540"},                                    // thorn
    {0xde, "m 0.5 0 l 0.5 7 m 0.5 5.6 l 2.7 5.6 A 2.7 3.7 1.9 1.9 90 -90 l 0.5 1.8"},                    // Thorn
    {0xf8, "a 2.45 2.5 2.05 2.5 90 450 m 0.4 -0.2 l 4.5 5.2"},  // o with stroke
    {0xd8, "a 3.6 3.5 3.2 3.5 90 450 m 0.7 -0.3 l 6.5 7.3"},    // O with stroke
    {box, "m 0.4 0 l 0.4 7 l 3.6 7 l 3.6 0 l 0.4 0"},
};

struct Glyph {
  std::vector<PenStroke> strokes;  // units, y up
  double advance = 0;
};

class Pen {
 public:
  explicit Pen(Glyph& glyph) : glyph_(glyph) {}
  void move(const Vec2& p) {
    finish();
    at_ = p;
    fresh_ = true;
    widest_ = std::max(widest_, p.x);
  }
  void line(const Vec2& p) {
    if (p != at_) glyph_.strokes.push_back({at_, p});
    at_ = p;
    fresh_ = false;
    widest_ = std::max(widest_, p.x);
  }
  void curve(const Vec2& control, const Vec2& end) {
    const Vec2 start = at_;
    constexpr int steps = 8;
    for (int i = 1; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      line(start * (1 - t) * (1 - t) + control * 2.0 * t * (1 - t) + end * t * t);
    }
  }
  void arc(const Vec2& centre, const Vec2& radius, double from, double to, bool joined) {
    const auto at = [&](double degrees) {
      const double a = degrees * std::numbers::pi / 180;
      return Vec2(centre.x + radius.x * std::cos(a), centre.y + radius.y * std::sin(a));
    };
    joined ? line(at(from)) : move(at(from));
    const int steps = static_cast<int>(std::ceil(std::abs(to - from) / 15));
    for (int i = 1; i <= steps; ++i)
      line(at(from + (to - from) * i / steps));
  }
  double finish() {
    if (fresh_) glyph_.strokes.push_back({at_, at_});
    fresh_ = false;
    return widest_;
  }

 private:
  Glyph& glyph_;
  Vec2 at_{0, 0};
  bool fresh_ = false;
  double widest_ = 0;
};

Glyph draw(const char* commands) {
  Glyph glyph;
  Pen pen(glyph);
  std::array<double, 6> v{};
  const auto numbers = [&](int count) {
    for (int i = 0; i < count; ++i) {
      char* end = nullptr;
      v[static_cast<std::size_t>(i)] = std::strtod(commands, &end);
      commands = end;
    }
  };
  while (*commands) {
    const char command = *commands++;
    switch (command) {
      case 'm':
        numbers(2), pen.move({v[0], v[1]});
        break;
      case 'l':
        numbers(2), pen.line({v[0], v[1]});
        break;
      case 'q':
        numbers(4), pen.curve({v[0], v[1]}, {v[2], v[3]});
        break;
      case 'a':
      case 'A':
        numbers(6), pen.arc({v[0], v[1]}, {v[2], v[3]}, v[4], v[5], command == 'A');
        break;
      default:
        break;
    }
  }
  glyph.advance = pen.finish() + gap;
  return glyph;
}

/// Marks over or under a letter, centred on 0, for a small letter.
enum class Mark { grave, acute, circumflex, tilde, diaeresis, ring, cedilla };
constexpr const char* marks[] = {"m -1 7.4 l 0.3 6.2",
                                 "m -0.3 6.2 l 1 7.4",
                                 "m -1.1 6.1 l 0 7.3 l 1.1 6.1",
                                 "m -1.3 6.3 q -0.6 7.4 0 6.8 q 0.6 6.2 1.3 7.2",
                                 "m -1 6.8 m 1 6.8",
                                 "a 0 6.9 0.8 0.8 90 450",
                                 "m 0.2 0 l 0 -0.8 q 1 -0.9 0.7 -1.6 q 0.2 -2.2 -0.7 -1.8"};

/// The letters of Western European languages with a mark, U+00C0 to U+00FF.
struct Marked {
  std::uint32_t code;
  char letter;
  Mark mark;
};
constexpr Marked marked[] = {
    {0xc0, 'A', Mark::grave},      {0xc1, 'A', Mark::acute},      {0xc2, 'A', Mark::circumflex},
    {0xc3, 'A', Mark::tilde},      {0xc4, 'A', Mark::diaeresis},  {0xc5, 'A', Mark::ring},
    {0xc7, 'C', Mark::cedilla},    {0xc8, 'E', Mark::grave},      {0xc9, 'E', Mark::acute},
    {0xca, 'E', Mark::circumflex}, {0xcb, 'E', Mark::diaeresis},  {0xcc, 'I', Mark::grave},
    {0xcd, 'I', Mark::acute},      {0xce, 'I', Mark::circumflex}, {0xcf, 'I', Mark::diaeresis},
    {0xd1, 'N', Mark::tilde},      {0xd2, 'O', Mark::grave},      {0xd3, 'O', Mark::acute},
    {0xd4, 'O', Mark::circumflex}, {0xd5, 'O', Mark::tilde},      {0xd6, 'O', Mark::diaeresis},
    {0xd9, 'U', Mark::grave},      {0xda, 'U', Mark::acute},      {0xdb, 'U', Mark::circumflex},
    {0xdc, 'U', Mark::diaeresis},  {0xdd, 'Y', Mark::acute},      {0xe0, 'a', Mark::grave},
    {0xe1, 'a', Mark::acute},      {0xe2, 'a', Mark::circumflex}, {0xe3, 'a', Mark::tilde},
    {0xe4, 'a', Mark::diaeresis},  {0xe5, 'a', Mark::ring},       {0xe7, 'c', Mark::cedilla},
    {0xe8, 'e', Mark::grave},      {0xe9, 'e', Mark::acute},      {0xea, 'e', Mark::circumflex},
    {0xeb, 'e', Mark::diaeresis},  {0xec, 'i', Mark::grave},      {0xed, 'i', Mark::acute},
    {0xee, 'i', Mark::circumflex}, {0xef, 'i', Mark::diaeresis},  {0xf1, 'n', Mark::tilde},
    {0xf2, 'o', Mark::grave},      {0xf3, 'o', Mark::acute},      {0xf4, 'o', Mark::circumflex},
    {0xf5, 'o', Mark::tilde},      {0xf6, 'o', Mark::diaeresis},  {0xf9, 'u', Mark::grave},
    {0xfa, 'u', Mark::acute},      {0xfb, 'u', Mark::circumflex}, {0xfc, 'u', Mark::diaeresis},
    {0xfd, 'y', Mark::acute},      {0xff, 'y', Mark::diaeresis},
};

/// Capitals are 2 higher, and their marks, too.
Glyph with_mark(const Glyph& letter, const Marked& one) {
  Glyph glyph = letter;
  const bool capital = one.letter < 'a';
  if (one.letter == 'i') {  // the mark takes the place of the dot
    std::erase_if(glyph.strokes, [](const PenStroke& stroke) { return stroke.from.y > 6; });
  }
  const double middle = (letter.advance - gap) / 2;
  const Vec2 shift(middle, capital && one.mark != Mark::cedilla ? 2 : 0);
  for (const PenStroke& stroke : draw(marks[static_cast<std::size_t>(one.mark)]).strokes)
    glyph.strokes.push_back({stroke.from + shift, stroke.to + shift});
  return glyph;
}

const Glyph& glyph_of(std::uint32_t code) {
  static const std::map<std::uint32_t, Glyph> glyphs = [] {
    std::map<std::uint32_t, Glyph> all;
    for (const Drawing& d : drawings)
      all.emplace(d.code, draw(d.commands));
    for (const Marked& one : marked)
      all.emplace(one.code, with_mark(all.at(static_cast<std::uint32_t>(one.letter)), one));
    all.emplace(' ', Glyph{{}, space_width + gap});
    for (char digit = '0'; digit <= '9'; ++digit)
      all[static_cast<std::uint32_t>(digit)].advance = 5.0 + gap;
    return all;
  }();
  const auto found = glyphs.find(code);
  return found == glyphs.end() ? glyphs.at(box) : found->second;
}

/// The next code point; advances `text` past it. A malformed byte yields the box.
std::uint32_t next_code(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t lead = byte(0);
  const std::size_t length = lead < 0x80 ? 1 : lead >= 0xc2 && lead < 0xe0 ? 2 : lead >= 0xe0 && lead < 0xf0 ? 3 : 0;
  std::uint32_t code = box;
  if (length == 1) {
    code = lead;
  } else if (length != 0 && text.size() >= length) {
    code = lead & (0x7fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte(i) & 0xc0u) != 0x80u) {
        text.remove_prefix(1);
        return box;
      }
      code = code << 6 | (byte(i) & 0x3fu);
    }
  }
  text.remove_prefix(code == box ? 1 : length);
  return code;
}

}  // namespace

double text_width(std::string_view text, double height) {
  double units = 0;
  while (!text.empty())
    units += glyph_of(next_code(text)).advance;
  return std::max(0.0, units - gap) * height / cap_height;
}

void write_text(std::string_view text, const Vec2& origin, double height, std::vector<PenStroke>& out) {
  const double scale = height / cap_height;
  double x = 0;
  while (!text.empty()) {
    const Glyph& glyph = glyph_of(next_code(text));
    for (const PenStroke& s : glyph.strokes) {
      out.push_back({{origin.x + (x + s.from.x) * scale, origin.y - s.from.y * scale},
                     {origin.x + (x + s.to.x) * scale, origin.y - s.to.y * scale}});
    }
    x += glyph.advance;
  }
}

}  // namespace palpa::drawing
