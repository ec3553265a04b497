#include "cli/calibrate.hpp"

#include <fmt/format.h>

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/process/progress.hpp"
#include "setup/tasks/background.hpp"
#include "setup/tasks/calibrate.hpp"

namespace palpa::cli {
namespace {

constexpr double degree = std::numbers::pi / 180;

void add_options_of_calibrate(CLI::App& app, CalibrateCommand& o) {
  const line::Group target(app, "The target");
  target.text("--target", o.target, "FILE",
              "only writes the model of the target: .stl for a printer (millimetres), or .glb for a viewer (on its "
              "mount, in the world)");
  target.point("--at", o.at,
               "place of the middle of the target's underside, in the array's frame [its mount on the layout]");
  target.number("--turn", o.turn_deg, {-360, 360}, "DEGREES",
                "angle of the target about its own z axis, counter-clockwise as seen from above");
  const line::Group frames(app, "What is seen, and where it goes");
  frames.text("--source", o.source, "SOURCE",
              "where depth frames come from: synthetic[:MESH] (a rehearsal), recording:DIR, v4l2:/dev/videoN[,...], "
              "realsense:SERIAL[,...] or bag:FILE; with --nudge, also a tracker of hands, joints:udp:PORT or "
              "joints:FILE [synthetic]");
  add_allow_outside(frames, o.common);
  frames.integer("--frames", o.frames, 0, std::uint64_t{1} << 62,
                 "number of frames that are averaged, 0 for 30; with --background, 0 for two seconds of them; with "
                 "--nudge, frames to run, 0 for no limit");
  frames.flag("--background", o.background,
              "learns what each camera sees without a hand, so that palpa run drops it; --out gets the rig with the "
              "names of the images, which are written beside it");
  frames.flag("--noise-free", o.noise_free, "renders synthetic frames without the sensor's noise");
  frames.text("--out", o.out, "FILE",
              "writes the rig with the poses that were found; must differ from --rig [no file]");
  setup::add_rig_options(app, o.rig);
  add_nudge_options(app, o);
  line::exclude(app, "--target", {"--source", "--frames", "--background", "--noise-free", "--out", "--nudge"});
  line::exclude(app, "--background", {"--at", "--turn", "--nudge"});
  line::exclude(app, "--nudge", {"--at", "--turn"});
  line::exclude(app, "--by-touch", {"--target", "--background", "--at", "--turn", "--scene", "--frames"});
}

/// What was written for a printer, and the next steps.
std::string after_printing(const CalibrateCommand& o, const array::Layout& layout) {
  const std::string rig = o.rig.rig.empty() ? "RIG" : o.rig.rig;
  return fmt::format(
      "{}: the target for {}, in millimetres, as it lies on the printer\n"
      "next: print it, put it on the array where all cameras see it, and run\n"
      "  palpa calibrate --rig {} --layout {} --source SOURCE --out calibrated.toml\n{}",
      o.target, layout.name, rig, o.rig.layout.empty() ? layout.name : o.rig.layout,
      o.rig.rig.empty() ? "palpa doctor --write-rig RIG writes a rig of the cameras that are plugged in\n" : "");
}

void write_target(const CalibrateCommand& o) {
  const setup::TargetPlace place{o.at, o.turn_deg};
  setup::check_target_file(o.target, place);
  if (!o.common.json.empty()) throw bad_usage("--target only writes the model: leave out --json");
  const Outputs outputs({{"--target", o.target}});
  const bool prints = setup::shows_summary(o.common, outputs);
  const setup::PlacedLayout placed = setup::load_placed_layout(o.rig);
  setup::write_target(o.target, place, placed);
  if (!prints) return;
  if (o.target.ends_with(".stl")) return write_file("-", after_printing(o, placed.layout));
  write_file("-", fmt::format("{}: the target on its mount on {}, in the world\n"
                              "next: look at it with palpa-viewer --scene {} --layout {}; --target FILE.stl writes it "
                              "for a printer\n",
                              o.target, placed.layout.name, o.target, placed.layout.name));
}

std::string summary_of_calibrate(const CalibrateCommand& o, const std::vector<setup::CalibratedCamera>& cameras) {
  std::string text;
  for (const setup::CalibratedCamera& camera : cameras) {
    const geometry::MeshFitted& fit = camera.found.fit;
    text += fmt::format("{}: {:.2f} mm rms, {:.2f} mm at 95 %, {} points; moved by {:.1f} mm and {:.2f} degrees\n",
                        camera.name, fit.rms_m * 1e3, fit.p95_m * 1e3, fit.points, camera.moved_m * 1e3,
                        camera.turned_rad / degree);
  }
  return text + (o.out.empty() ? "nothing written: give --out\n" : fmt::format("written to {}\n", o.out));
}

setup::StillTask frames_of(const CalibrateCommand& o) {
  return {.source = o.source, .frames = o.frames, .noise_free = o.noise_free, .seed = o.common.seed, .rig = o.rig};
}

/// A bar for the frames that are taken.
setup::CalibrateWatch shown_in(std::optional<setup::Progress>& progress, bool quiet) {
  return {.opened =
              [&progress, quiet](std::uint64_t frames) {
                log::release_warnings();
                progress.emplace("frames", frames, quiet);
              },
          .taken = [&progress](std::uint64_t done) { progress->set(done); },
          .all_taken = [&progress] { progress.reset(); }};
}

void find_poses(const Extensions& extensions, const CalibrateCommand& o) {
  const setup::CalibrateTask task{frames_of(o), {o.at, o.turn_deg}};
  check(task);
  if (!o.out.empty() && o.source.empty())
    throw bad_usage("--out needs --source: a rehearsal finds the poses that the rig already has");
  const Outputs outputs({{"--json", o.common.json}, {"--out", o.out}});
  std::optional<setup::Progress> progress;
  const setup::CalibrateResult result = calibrate(task, extensions.sources, shown_in(progress, o.common.quiet));
  if (!o.out.empty()) setup::write_rig(o.out, result.rig);
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_calibrate(o, result.cameras));
}

std::string summary_of_background(const CalibrateCommand& o, const setup::BackgroundResult& result) {
  std::string text;
  for (const setup::BackgroundOfCamera& camera : result.cameras) {
    const sensing::LearnedBackground& learned = camera.learned;
    text += fmt::format("{}: {} pixels, {} of them unsteady; noise {:.2f} mm, so skin is at least {:.1f} mm nearer{}\n",
                        camera.name, learned.pixels, learned.unsteady, learned.noise_m * 1e3,
                        learned.background.margin_m * 1e3, camera.file.empty() ? "" : ": " + camera.file);
  }
  return text + (o.out.empty() ? "nothing written: give --out\n" : fmt::format("written to {}\n", o.out));
}

void learn_background(const Extensions& extensions, const CalibrateCommand& o) {
  const setup::BackgroundTask task{frames_of(o), o.out};
  check(task);
  std::vector<Output> files{{"--json", o.common.json}, {"--out", o.out}};
  for (const std::string& image : setup::images_of(task))
    files.push_back({"--out", image});
  const Outputs outputs(files);
  std::optional<setup::Progress> progress;
  const setup::BackgroundResult result =
      setup::learn_background(task, extensions.sources, shown_in(progress, o.common.quiet));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_background(o, result));
}

void run_calibrate(const Extensions& extensions, const CalibrateCommand& o) {
  if (o.by_touch) return run_by_touch(extensions, o);
  if (o.nudge) return run_nudge(extensions, o);
  if (!o.common.gpu.empty() || o.common.validation)
    throw bad_usage("--gpu and --validation go with --nudge: all else of palpa calibrate uses the processor");
  if (!o.target.empty()) return write_target(o);
  if (o.background) return learn_background(extensions, o);
  find_poses(extensions, o);
}

}  // namespace

void add_calibrate(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<CalibrateCommand>(
      program,
      {"calibrate", "where the cameras are, by a printed target or by touch",
       "  palpa calibrate --target target.stl --layout openmpd\n"
       "  palpa calibrate --rig my-cameras.toml --layout openmpd --source v4l2:/dev/video0 --out rig.toml",
       "--target --rig --layout --source --out --frames --background --nudge --by-touch --link",
       "palpa doctor --write-rig writes a rig to begin with; docs/calibration.md has all steps."},
      add_options_of_calibrate, [&extensions](const CalibrateCommand& o) { run_calibrate(extensions, o); });
}

}  // namespace palpa::cli
