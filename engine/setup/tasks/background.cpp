#include "setup/tasks/background.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "sensing/rig_toml.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::setup {
namespace {

constexpr std::uint64_t most_frames = 1000, least_frames = 10;
constexpr double seconds = 2, default_rate_hz = 90;

std::uint64_t frames_of(const BackgroundTask& task, const std::vector<sensing::Camera>& cameras) {
  if (task.frames != 0) return task.frames;
  double rate_hz = 0;
  for (const sensing::Camera& camera : cameras)
    rate_hz = std::max(rate_hz, camera.rate_hz);
  const double frames = std::ceil(seconds * (rate_hz > 0 ? rate_hz : default_rate_hz));
  return static_cast<std::uint64_t>(std::clamp(frames, double{least_frames}, double{most_frames}));
}

/// A camera's name as a part of a file's name.
std::string word_of(const std::string& name) {
  std::string word;
  for (const char c : name)
    word += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' ? c : '-';
  return word;
}

std::vector<std::string> images_beside(const std::string& out, const std::vector<sensing::Camera>& cameras) {
  std::vector<std::string> files;
  const std::filesystem::path rig(out);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto file_for = [&](const std::string& word) {
      return (rig.parent_path() / fmt::format("{}-{}.png", rig.stem().string(), word)).string();
    };
    std::string file = file_for(word_of(cameras[i].name));
    if (std::ranges::find(files, file) != files.end()) file = file_for(fmt::format("camera-{}", i + 1));
    files.push_back(std::move(file));
  }
  return files;
}

void warn_of(const BackgroundOfCamera& camera) {
  const sensing::LearnedBackground& learned = camera.learned;
  if (learned.pixels == 0) {
    log::warning(
        fmt::format("camera \"{}\": it saw nothing, so it has an empty background", printable(camera.name, 60)));
    return;
  }
  const double share = static_cast<double>(learned.unsteady) / static_cast<double>(learned.pixels);
  if (share <= sensing::default_unsteady) return;
  log::warning(fmt::format(
      "camera \"{}\": {:.0f} % of its pixels differ from frame to frame, so something moved while the background was "
      "learned; keep hands and cables out of sight, and learn it again",
      printable(camera.name, 60), 100 * share));
}

}  // namespace

void check(const BackgroundTask& task) {
  if (task.frames != 0 && (task.frames < least_frames || task.frames > most_frames)) {
    throw bad_usage(
        fmt::format("--frames {}: a background is learned from {} to {}", task.frames, least_frames, most_frames));
  }
  check(static_cast<const StillTask&>(task));
  if (!task.out.empty() && task.source.empty())
    throw bad_usage("--out needs --source: a rehearsal sees no real background");
}

std::vector<std::string> images_of(const BackgroundTask& task) {
  if (task.out.empty()) return {};
  return images_beside(task.out, load_posed_rig(task.rig).rig.cameras);
}

BackgroundResult learn_background(const BackgroundTask& task, std::span<const session::SourceKind> sources,
                                  const CalibrateWatch& watch) {
  check(task);
  const PosedRig posed = load_posed_rig(task.rig);
  const auto source = open_still_source(task, posed, sources, {});
  check_same_cameras(posed.rig.cameras, source->cameras(), posed.rig.file);
  for (std::size_t i = 0; i < posed.rig.cameras.size(); ++i) {
    const double own = posed.rig.cameras[i].depth_unit_m, its = source->cameras()[i].depth_unit_m;
    if (std::abs(own / its - 1) < 1e-6) continue;
    throw bad_input(posed.rig.file, fmt::format("its [[camera]] {} has depth_unit_m = {:g}, and the source's has {:g}: "
                                                "set it in the rig, because the background is in this unit",
                                                i + 1, own, its));
  }
  const std::uint64_t frames = frames_of(task, source->cameras());
  if (watch.opened) watch.opened(frames);
  std::vector<sensing::BackgroundFrames> seen;
  for (const sensing::Camera& camera : source->cameras())
    seen.emplace_back(camera, frames);
  BackgroundResult result;
  result.frames = take_frames(*source, frames, [&](const sensing::FrameSet& set) {
    for (std::size_t i = 0; i < seen.size(); ++i)
      seen[i].add(set.frames[i].depth);
    if (watch.taken) watch.taken(seen.front().frames());
  });
  if (watch.all_taken) watch.all_taken();
  if (result.frames < least_frames) {
    throw failure(
        fmt::format("--source: it ended after {} frames; a background needs at least {}", result.frames, least_frames));
  }
  sensing::Rig rig = rig_to_write(posed, task.rig);
  const std::vector<std::string> files =
      task.out.empty() ? std::vector<std::string>(seen.size()) : images_beside(task.out, rig.cameras);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    BackgroundOfCamera& camera = result.cameras.emplace_back();
    camera = {rig.cameras[i].name, seen[i].finish(), files[i]};
    warn_of(camera);
    if (files[i].empty()) continue;
    sensing::Background background = camera.learned.background;
    background.file = std::filesystem::path(files[i]).filename().string();  // beside the rig
    rig.cameras[i].background = std::make_shared<sensing::Background>(std::move(background));
    sensing::write_background(files[i], rig.cameras[i]);
  }
  if (!task.out.empty()) write_rig(task.out, rig);
  return result;
}

std::string to_json(const BackgroundResult& result) {
  JsonWriter json;
  json.begin_object().member("frames", result.frames).key("cameras").begin_array(JsonWriter::Style::block);
  for (const BackgroundOfCamera& camera : result.cameras) {
    json.begin_object(JsonWriter::Style::line).member("name", camera.name).member("pixels", camera.learned.pixels);
    json.member("unsteady", camera.learned.unsteady).member("noise_m", camera.learned.noise_m);
    json.member("margin_m", camera.learned.background.margin_m).key("file");
    camera.file.empty() ? json.null() : json.value(camera.file);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

}  // namespace palpa::setup
