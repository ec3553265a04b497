#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <string>
#include <system_error>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/recording.hpp"
#include "sensing/rig_toml.hpp"

namespace palpa::sensing {
namespace {

/// It is open, and so locked, while the recording grows.
constexpr const char* times_name = "times.csv";

std::string mask_name(std::size_t camera) {
  return fmt::format("mask-{}.png", camera);
}

std::string background_name(std::size_t camera) {
  return fmt::format("background-{}.png", camera);
}

/// The camera as in the recording's TOML: its mask and background are in the folder.
Camera kept_camera(const Camera& camera, std::size_t index) {
  Camera kept = camera;
  if (camera.mask) kept.mask = std::make_shared<Mask>(Mask{mask_name(index), camera.mask->pixels});
  if (camera.background) {
    kept.background = std::make_shared<Background>(
        Background{background_name(index), camera.background->depth, camera.background->margin_m});
  }
  return kept;
}

/// The files of a recording that this writer wrote, `recording.toml` last: what is left after an interrupted deletion
/// is still a folder that can be replaced. Throws bad_usage if there is anything else.
std::vector<std::filesystem::path> files_to_replace(const std::filesystem::path& folder) {
  static const std::regex ours(R"(times\.csv|mask-[0-9]+\.png|background-[0-9]+\.png|[0-9]{6,}-[0-9]+\.png)");
  std::vector<std::filesystem::path> files;
  bool has_toml = false;
  std::error_code fault;
  for (std::filesystem::directory_iterator file(folder, fault), end; !fault && file != end; file.increment(fault)) {
    const std::string name = file->path().filename().string();
    const bool is_toml = name == "recording.toml";
    std::error_code ignored;
    if (file->is_directory(ignored) || !(is_toml || std::regex_match(name, ours))) {
      throw bad_usage(fmt::format("{} has {}, which is not part of a recording; name a new folder", folder.string(),
                                  printable(name, 60)));
    }
    if (!is_toml) files.push_back(file->path());
    has_toml = has_toml || is_toml;
  }
  if (fault) throw failure(fmt::format("{}: cannot be read: {}", folder.string(), fault.message()));
  if (!has_toml) {
    throw bad_usage(
        fmt::format("{} has no recording.toml, so it is not a recording; name a new folder", folder.string()));
  }
  files.push_back(folder / "recording.toml");
  return files;
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& folder, const std::vector<Camera>& cameras,
                                 Existing existing)
    : folder_(folder), cameras_(cameras) {
  if (cameras.empty()) throw bad_usage("a recording needs a camera");
  made_folder_ = make_folder(folder);
  std::error_code error;
  if (std::filesystem::is_empty(folder, error)) {
    begin();
    return;
  }
  if (existing == Existing::refused)
    throw bad_usage(fmt::format("{} is not empty; name a new folder", folder.string()));
  refuse_while_written();
  old_ = files_to_replace(folder);
}

/// Throws bad_usage while another one writes a recording in the folder.
void RecordingWriter::refuse_while_written() const {
  if (std::error_code fault; std::filesystem::exists(folder_ / times_name, fault)) open_to_append(folder_ / times_name);
}

void RecordingWriter::begin() {
  if (!old_.empty()) refuse_while_written();  // another recording may have begun meanwhile
  for (const std::filesystem::path& file : old_) {
    writable_place(file);  // refuses a file that was read, under whatever name
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) throw failure(fmt::format("{}: cannot be replaced: {}", file.string(), error.message()));
  }
  std::string text = "[recording]\nfiles = [";
  for (std::size_t i = 0; i < cameras_.size(); ++i)
    text += fmt::format("{}\"%06d-{}.png\"", i == 0 ? "" : ", ", i);
  text += "]\ntimes = \"times.csv\"\n\n";
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const Camera kept = kept_camera(cameras_[i], i);
    if (kept.mask) write_png8(folder_ / kept.mask->file, kept.width, kept.height, kept.mask->pixels);
    if (kept.background) write_background(folder_ / kept.background->file, kept);
    text += to_toml(kept) + "\n";
  }
  write_file(folder_ / "recording.toml", text);
  times_ = open_output(folder_ / times_name);
  times_->write(times_heading(cameras_.size()) + "\n");
}

bool RecordingWriter::write(const FrameSet& set) {
  if (set.frames.size() != cameras_.size()) {
    throw bad_usage(
        fmt::format("{} for {}", counted(set.frames.size(), "depth frame"), counted(cameras_.size(), "camera")));
  }
  std::string line = fmt::format("{}", set.sequence);
  double oldest = set.frames.front().time_s;
  for (const DepthFrame& frame : set.frames) {
    line += fmt::format(",{}", frame.time_s);
    oldest = std::min(oldest, frame.time_s);
  }
  if (frames_ > 0 && !(oldest > last_time_ && set.sequence > last_sequence_)) return false;
  if (!times_) begin();
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    write_png16(folder_ / fmt::format("{:06}-{}.png", frames_, i), cameras_[i].width, cameras_[i].height,
                set.frames[i].depth);
  }
  // The line makes the frame part of the recording, so it is written last, in one piece.
  times_->write(line + "\n");
  last_time_ = oldest;
  last_sequence_ = set.sequence;
  ++frames_;
  return true;
}

void RecordingWriter::discard() {
  if (frames_ > 0 || !times_) return;
  times_.reset();
  std::error_code ignored;
  for (const char* file : {"recording.toml", times_name})
    std::filesystem::remove(folder_ / file, ignored);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    std::filesystem::remove(folder_ / mask_name(i), ignored);
    std::filesystem::remove(folder_ / background_name(i), ignored);
  }
  if (made_folder_) std::filesystem::remove(folder_, ignored);
}

}  // namespace palpa::sensing
