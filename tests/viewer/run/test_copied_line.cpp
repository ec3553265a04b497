// The command line that is copied for a picture draws that picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <set>
#include <string>
#include <vector>

#include "drawing/png.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/app/app.hpp"
#include "viewer/options/view_line.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer/run/interact.hpp"
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

TEST_F(CopiedLine, DrawsThePictureAgain) {
  const std::vector<std::string> line = test::cube_touch({"--backend", "cpu", "--layout", "autd3", "--show", "sections",
                                                          "--hide", "grid", "--opacity", "solids=0.5", "--dark"});
  const auto folder = test::scratch_folder("viewer-copied");
  const std::string shown = (folder / "shown.png").string(), copied = (folder / "copied.png").string();
  const std::string script = "key space\ndrag 100 80 140 90\nscroll 2\nkey 5\nkey .\ndraw\n";
  test::write_text(folder / "script", script);
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
  std::atomic<bool> stop{false};
  std::string text;
  const Size size{320, 200};
  App app(options_of(given), size,
          {.stop = &stop, .copy = [&](const std::string& copy) { text = copy; }, .panels = false});
  for (const Interaction& step : parse_interactions(script + "key c\n", "script")) {
    if (step.kind == Interaction::Kind::event) app.handle(step.event, size);
    app.advance(0.01, size);
  }
  std::vector<std::string> again = words_of(text);
  std::ranges::replace(again, "picture.png", copied);
  ASSERT_GT(again.size(), 3u) << text;
  again.erase(again.begin());
  again.emplace_back("--quiet");
  const auto run = test::viewer_here(again);
  ASSERT_EQ(run.exit_code, 0) << run.err << "\n" << text;
  EXPECT_LT(drawing::mean_difference(drawing::read_png(shown), drawing::read_png(copied)), 1e-4) << text;
}

/// What the view does not say itself stands in the line as it was given.
TEST(PictureCommand, KeepsEveryOptionThatIsNotOfTheView) {
  const std::set<std::string> of_the_view{"--show",       "--hide",  "--opacity", "--explode", "--slice", "--slice-at",
                                          "--slice-size", "--heat",  "--dark",    "--fine",    "--view",  "--eye",
                                          "--target",     "--frame", "--ortho",   "--slot",    "--json"};
  const std::set<std::string> elsewhere{"What the participant sees", "Mouse and keys, panels", "Without a window"};
  const auto copied = [](const line::Given& given) {
    ViewerOptions options;
    options.given = given;
    return picture_command(options, {}, {.size = {320, 200}});
  };
  for (const line::OptionInfo& option : viewer_table()) {
    const std::vector<std::string> words = words_of(copied({{option.name, {"as given"}}}));
    const auto at = std::ranges::find(words, option.name);
    const bool kept = at != words.end() && at + 1 != words.end() && at[1] == "as given";
    EXPECT_EQ(kept, !of_the_view.contains(option.name) && !elsewhere.contains(option.heading)) << option.name;
  }
}

}  // namespace
}  // namespace palpa
