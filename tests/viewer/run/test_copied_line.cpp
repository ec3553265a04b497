// The command line that is copied for a picture draws that picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include "drawing/png.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/app/app.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer_here.hpp"

namespace palpa {
namespace {

using CopiedLine = test::DrawingTest;

using namespace viewer;

/// The words of a command line as a shell splits it, with quotes, but without escapes.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '\'') {
      quoted = !quoted;
    } else if (c == ' ' && !quoted) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

void expect_same_picture(const std::vector<std::string>& line) {
  const auto folder = test::scratch_folder("viewer-copied");
  const std::string shown = (folder / "shown.png").string(), copied = (folder / "copied.png").string();
  test::write_text(folder / "script", "key space\ndrag 100 80 140 90\nscroll 2\nkey 5\nkey .\ndraw\n");
  ASSERT_EQ(test::viewer_here(test::with(line, {"--headless", "--quiet", "--interact", (folder / "script").string(),
                                                "--screenshot", shown}))
                .exit_code,
            0);
  // The same by an application whose clipboard can be read.
  line::Given given;
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::vector<std::string>& values = given[line[i]];
    if (i + 1 < line.size() && !line[i + 1].starts_with("--")) values.push_back(line[++i]);
  }
  const ViewerOptions options = options_of(given);
  std::atomic<bool> stop{false};
  std::string text;
  AppHost host;
  host.stop = &stop;
  host.panels = false;
  host.copy = [&](const std::string& copy) { text = copy; };
  const Size size{320, 200};
  App app(options, size, std::move(host));
  const auto event = [&](WindowEvent::Kind kind, double x, double y, Key key = Key::other) {
    WindowEvent e;
    e.kind = kind;
    e.x = x, e.y = y;
    e.key = key;
    e.steps = 2;
    app.handle(e, size);
    app.advance(0.01, size);
  };
  using Kind = WindowEvent::Kind;
  event(Kind::key, 0, 0, Key::space);
  event(Kind::move, 100, 80);
  event(Kind::press, 100, 80);
  event(Kind::move, 120, 85);
  event(Kind::move, 140, 90);
  event(Kind::release, 140, 90);
  event(Kind::scroll, 140, 90);
  event(Kind::key, 0, 0, key_of('5'));
  event(Kind::key, 0, 0, key_of('.'));
  event(Kind::key, 0, 0, key_of('c'));
  std::vector<std::string> again = words_of(text);
  std::ranges::replace(again, "picture.png", copied);
  ASSERT_GT(again.size(), 3u) << text;
  again.erase(again.begin());
  again.emplace_back("--quiet");
  const auto run = test::viewer_here(again);
  ASSERT_EQ(run.exit_code, 0) << run.err << "\n" << text;
  EXPECT_LT(drawing::mean_difference(drawing::read_png(shown), drawing::read_png(copied)), 1e-4) << text;
}

TEST_F(CopiedLine, DrawsThePictureAgain) {
  expect_same_picture(test::with(test::cube_touch({"--backend", "cpu", "--layout", "autd3"}),
                                 {"--show", "sections", "--hide", "grid", "--opacity", "solids=0.5", "--dark"}));
}

}  // namespace
}  // namespace palpa
