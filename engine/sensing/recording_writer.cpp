#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/output_file.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/recording.hpp"
#include "sensing/rig_toml.hpp"

namespace palpa::sensing {
namespace {

/// The size of one line of times.csv.
constexpr std::size_t most_waiting = 1 << 16;

/// Waits until the whole line is on the disk, however long that takes, as for the images.
void put(StreamWriter& out, const std::string& line) {
  constexpr double forever_s = 1e6;
  if (!out.add(line) || !out.flush(forever_s)) out.fail_stalled();
}

std::string mask_name(std::size_t camera) {
  return fmt::format("mask-{}.png", camera);
}

/// The camera as in the recording's TOML: its mask is in the folder.
Camera kept_camera(const Camera& camera, std::size_t index) {
  Camera kept = camera;
  if (camera.mask) kept.mask = std::make_shared<Mask>(Mask{mask_name(index), camera.mask->pixels});
  return kept;
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& folder, const std::vector<Camera>& cameras)
    : folder_(folder), cameras_(cameras) {
  if (cameras.empty()) throw bad_usage("a recording needs a camera");
  std::error_code error;
  made_folder_ = std::filesystem::create_directory(folder, error);
  if (error) throw failure(fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
  if (!std::filesystem::is_empty(folder, error)) {
    throw bad_usage(fmt::format("{} is not empty, name a new folder", folder.string()));
  }

  std::string text = "[recording]\nfiles = [";
  for (std::size_t i = 0; i < cameras.size(); ++i)
    text += fmt::format("{}\"%06d-{}.png\"", i == 0 ? "" : ", ", i);
  text += "]\ntimes = \"times.csv\"\n\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera kept = kept_camera(cameras[i], i);
    if (kept.mask) write_png8(folder / kept.mask->file, kept.width, kept.height, kept.mask->pixels);
    text += to_toml(kept) + "\n";
  }
  write_file(folder / "recording.toml", text);
  times_.emplace((folder / "times.csv").string(), most_waiting);
  put(*times_, times_heading(cameras.size()) + "\n");
}

bool RecordingWriter::write(const FrameSet& set) {
  if (set.frames.size() != cameras_.size()) {
    throw bad_usage(fmt::format("{} depth frames for {} cameras", set.frames.size(), cameras_.size()));
  }
  std::string line = fmt::format("{}", set.sequence);
  double oldest = set.frames.front().time_s;
  for (const DepthFrame& frame : set.frames) {
    line += fmt::format(",{}", frame.time_s);
    oldest = std::min(oldest, frame.time_s);
  }
  if (frames_ > 0 && !(oldest > last_time_ && set.sequence > last_sequence_)) return false;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    write_png16(folder_ / fmt::format("{:06}-{}.png", frames_, i), cameras_[i].width, cameras_[i].height,
                set.frames[i].depth);
  }
  // The line makes the frame part of the recording, so it is written last, in one piece.
  put(*times_, line + "\n");
  last_time_ = oldest;
  last_sequence_ = set.sequence;
  ++frames_;
  return true;
}

void RecordingWriter::discard() {
  if (frames_ > 0) return;
  times_.reset();
  std::error_code ignored;
  for (const char* file : {"recording.toml", "times.csv"})
    std::filesystem::remove(folder_ / file, ignored);
  for (std::size_t i = 0; i < cameras_.size(); ++i)
    std::filesystem::remove(folder_ / mask_name(i), ignored);
  if (made_folder_) std::filesystem::remove(folder_, ignored);
}

}  // namespace palpa::sensing
