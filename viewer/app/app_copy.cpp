// What is shown, as command lines.
#include "viewer/app/app.hpp"
#include "viewer/options/view_line.hpp"

namespace palpa::viewer {

void App::copy_command(double now_s) {
  if (!data_.live && !data_.edit.line().contains("--source"))
    return say(log::Level::info, "Ctrl C: this is one touch and no run; C copies the picture's command line", now_s);
  const std::string command = data_.edit.command();
  if (around_.copy) around_.copy(command);
  say(log::Level::info, "copied: " + command, now_s);
  if (moved_.placing().moved())
    say(log::Level::warning, "the command line does not have the moved things: save the scene, then copy", now_s);
}

void App::copy_picture(double now_s, const Size& size) {
  const SeenView seen{data_.state, size, ratio_, slice_.placed, data_.numbers.frames, slice_.asked.plane};
  const std::string command = picture_command(options_, data_.live ? data_.edit.line() : setup::Given(), seen);
  if (around_.copy) around_.copy(command);
  say(log::Level::info, "copied: " + command, now_s);
  if (moved_.placing().moved())
    say(log::Level::warning, "the command line does not have the moved things: save the scene, then copy", now_s);
}

}  // namespace palpa::viewer
