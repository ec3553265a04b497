#include "setup/options/study_options.hpp"

#include <fmt/core.h>

#include <charconv>
#include <system_error>

#include "base/error.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "study/plan/order.hpp"

namespace palpa::setup {

void add_override(const line::Group& group, std::string& who) {
  group.text("--override", who, "TEXT",
             "accepts a level above the plan's limit; a signature, such as the number of an ethics decision");
}

void add_eyes_options(const line::Group& group, EyesOptions& o) {
  group.quantity("--eyes-apart", o.eyes_apart_m, Quantity::length, line::positive(1), "distance between the eyes");
  group.quantity("--barrier-pitch", o.barrier_pitch_m, Quantity::length, line::positive(1),
                 "with --stereo columns, the distance between slits; with rows, that of two rows [so that neighbours "
                 "differ]");
  group.quantity("--barrier-gap", o.barrier_gap_m, Quantity::length, {-1, 1},
                 "distance from the screen to its barrier [so that neighbours differ]");
  group.number("--barrier-phase", o.barrier_phase, {0, 1}, "PART", "place of the slits, as a part of the pitch");
}

void add_study_run_options(CLI::App& app, StudyRunOptions& o) {
  const line::Group sitting(app, "Sitting");
  sitting.integer("--participant", o.participant, 1, study::most_participant_number, "number of the participant");
  sitting.text("--out", o.out, "DIR", "folder of the study; the participant's folder is made in it");
  add_override(sitting, o.override_by);
  sitting.number("--rehearse", o.rehearse, {0, 1}, "NUMBER",
                 "a scripted participant with this share of right answers presses the keys [a person]");
  const line::Group what(app, "What to run");
  what.text("--source", o.source, "SOURCE", "where frames come from, as in palpa run [with --rehearse: synthetic]");
  what.text("--link", o.link, "LINK", "the array that sounds, as in palpa run [with --rehearse: null]");
  what.text("--rig", o.rig, "FILE", "the cameras, the array and the screen with their poses [the paper's]");
  add_board_files(what, o.board_files);
  add_hold(what, o.hold_s, o.hold_auto);
  const line::Group windows(app, "Windows");
  windows.text("--monitor", o.monitor, "NAME|NUMBER",
               "monitor that the participant's window fills [the last, if there are several]");
  windows.text("--size", o.size, "WxH", "size of the participant's window in pixels; it then fills no monitor");
  windows.text("--stereo", o.stereo, "HOW",
               "how the pictures of two eyes become one: none, side-by-side, top-bottom, anaglyph, columns (an "
               "autostereoscopic display with upright slits) or rows [none]");
  add_eyes_options(windows, o);
  line::exclude(app, "--monitor", {"--size"});
}

void check(StudyRunOptions& o) {
  if (o.plan.empty()) throw bad_usage("give the plan of the study, such as assets/studies/paper.toml");
  if (!o.participant) throw bad_usage("--participant is missing: give a number, such as 1");
  if (o.out.empty()) throw bad_usage("--out is missing: give the folder of the study");
  if (o.rehearse) {
    if (o.source.empty()) o.source = "synthetic";
    if (o.link.empty()) o.link = "null";
  }
  if (o.source.empty())
    throw bad_usage("--source is missing: give a camera, as for palpa run, or --rehearse for a scripted participant");
  if (o.link.empty())
    throw bad_usage("--link is missing: give an array, as for palpa run, or --rehearse for a scripted participant");
  if (!o.size.empty()) parse_window_size("--size", o.size);
  const StudyRunOptions usual;
  if ((o.stereo.empty() || o.stereo == "none") && o.eyes_apart_m != usual.eyes_apart_m)
    throw bad_usage("--eyes-apart goes with --stereo");
  const bool barrier = o.barrier_pitch_m || o.barrier_gap_m || o.barrier_phase != usual.barrier_phase;
  if (barrier && o.stereo != "columns" && o.stereo != "rows")
    throw bad_usage("--barrier-pitch, --barrier-gap and --barrier-phase go with --stereo columns or rows");
}

WindowSize parse_window_size(const std::string& option, const std::string& text) {
  WindowSize size;
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, size.height);
    const auto fits = [](std::uint32_t v) { return v >= 16 && v <= 8192; };
    if (height.ec == std::errc() && height.ptr == end && fits(size.width) && fits(size.height)) return size;
  }
  throw bad_usage(fmt::format("{}: '{}' is not a size; give width x height, 16 to 8192 pixels each, such as 1280x800",
                              option, text));
}

}  // namespace palpa::setup
