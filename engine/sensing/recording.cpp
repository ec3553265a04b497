#include "sensing/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/lines.hpp"
#include "base/files/outputs.hpp"
#include "base/files/reference.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig_toml.hpp"

namespace palpa::sensing {

std::string times_heading(std::size_t cameras) {
  std::string heading = "sequence";
  for (std::size_t i = 0; i < cameras; ++i)
    heading += fmt::format(",time_{}_s", i);
  return heading;
}

std::string implausible_times(std::span<const double> times_s, double rate_hz) {
  constexpr double longest_step_s = 5, most_apart = 10, least_counted_hz = 2;
  if (times_s.size() < 2) return {};
  std::vector<double> steps;
  for (std::size_t i = 1; i < times_s.size(); ++i)
    steps.push_back(times_s[i] - times_s[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double ratio = rate_hz > 0 ? *middle * rate_hz : 1;
  const bool contradicts = ratio > most_apart || ratio < 1 / most_apart;
  const bool counts = *middle == 1 && (rate_hz <= 0 || rate_hz >= least_counted_hz) &&
                      std::ranges::all_of(times_s, [](double time) { return time == std::floor(time); });
  if (!contradicts && !counts && *middle <= longest_step_s) return {};
  return fmt::format("its frames are {:.3g} s apart{}; if the times are {}, convert them: they must be in seconds",
                     *middle,
                     rate_hz > 0 && (contradicts || counts)
                         ? fmt::format(", but its rate_hz of {:g} means {:.3g} s", rate_hz, 1 / rate_hz)
                         : "",
                     counts ? "frame numbers" : "in another unit");
}

namespace {

constexpr std::uint64_t most_frames = 1'000'000;
constexpr std::uint64_t most_bytes = 256u << 20;  // of times.csv
constexpr double most_seconds = 1e12;             // in both directions

/// A printf-like pattern with exactly one %d, %4d or %04d.
struct Pattern {
  std::string before, after;
  int width = 0;
  char fill = ' ';

  std::string name(std::uint64_t frame) const {
    const std::string digits = fmt::format("{}", frame);
    const std::size_t missing = digits.size() < static_cast<std::size_t>(width) ? width - digits.size() : 0;
    return before + std::string(missing, fill) + digits + after;
  }
};

std::optional<Pattern> parse_pattern(const std::string& text) {
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) return std::nullopt;
  Pattern pattern;
  pattern.before = text.substr(0, percent);
  std::size_t at = percent + 1;
  if (at < text.size() && text[at] == '0') {
    pattern.fill = '0';
    ++at;
  }
  while (at < text.size() && text[at] >= '0' && text[at] <= '9' && pattern.width < 20) {
    pattern.width = pattern.width * 10 + (text[at++] - '0');
  }
  if (at >= text.size() || text[at] != 'd' || pattern.width > 20) return std::nullopt;
  pattern.after = text.substr(at + 1);
  if (pattern.after.find('%') != std::string::npos) return std::nullopt;
  return pattern;
}

struct Times {
  std::vector<std::vector<double>> rows;
  std::vector<std::uint64_t> sequences;
};

/// `sequence,time,time,...` per frame after a heading.
Times read_times(const std::filesystem::path& file, std::size_t cameras) {
  const std::string text = read_text_file(file, most_bytes);
  Times times;
  std::size_t blank = 0;  // the first blank line
  Lines lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->find_first_not_of(" \t") == std::string_view::npos) {
      blank = blank == 0 ? lines.number() : blank;
      continue;
    }
    const auto fault = [&](const std::string& what) {
      return bad_input(file.string(), fmt::format("line {}: {}", lines.number(), what));
    };
    if (lines.number() == 1) {
      if (*line != times_heading(cameras)) throw fault(fmt::format("expected the heading {}", times_heading(cameras)));
      continue;
    }
    std::optional<std::uint64_t> sequence;
    std::vector<double> row;
    if (std::ranges::count(*line, ',') == static_cast<std::ptrdiff_t>(cameras)) {
      const std::vector<std::string_view> cells = cells_of(*line, ',');
      sequence = parse_whole<std::uint64_t>(cells[0]);
      for (const std::string_view cell : std::span(cells).subspan(1)) {
        const std::optional<double> time = parse_number(cell);
        if (time && std::abs(*time) <= most_seconds) row.push_back(*time);
      }
    }
    std::string broken;
    if (!sequence || row.size() != cameras) {
      broken = fmt::format("expected a sequence number and {} in seconds, none beyond 1e12", counted(cameras, "time"));
    } else if (!times.rows.empty() && *sequence <= times.sequences.back()) {
      broken = "the sequence number does not increase";
    } else if (!times.rows.empty() && !(std::ranges::min(row) > std::ranges::min(times.rows.back()))) {
      broken = "the time does not increase";
    }
    if (!broken.empty() && !lines.cut()) throw fault(broken);
    if (!broken.empty()) {
      log::warning(fmt::format("{}: line {} has no end, and is no whole frame; it is left out: {}", file.string(),
                               lines.number(), broken));
      break;
    }
    if (times.rows.size() == most_frames) throw fault(fmt::format("more than {} frames", most_frames));
    times.rows.push_back(std::move(row));
    times.sequences.push_back(*sequence);
  }
  if (blank > 0) log::warning(fmt::format("{}: line {} is blank; it counts as no frame", file.string(), blank));
  return times;
}

/// Why the file is not an image; empty if it is one.
std::string fault_of(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) return "no such image";
  if (status.type() == fs::file_type::none) return "cannot be opened: " + error.message();
  if (status.type() == fs::file_type::directory) return "is a folder, an image is needed";
  return status.type() == fs::file_type::regular ? "" : "is not a regular file";
}

/// The images of a frame must exist when the recording is opened, so that a gap shows at once and not minutes later.
void add_files(Recording::Entry& entry, ReferenceFolder& folder, const std::string& name) {
  entry.files.push_back(folder.find(name, "files"));
  const std::string fault = fault_of(entry.files.back());
  if (!fault.empty()) throw bad_input(entry.files.back().string(), fault);
  refuse_output_as_input(entry.files.back());
}

/// Entries from `files`: one pattern per camera.
void list_patterns(TomlTable& table, ReferenceFolder& folder, std::optional<std::uint64_t> frames,
                   Recording& recording) {
  std::vector<Pattern> patterns;
  const std::vector<std::string> texts = table.texts("files");
  if (texts.size() != recording.cameras.size()) {
    throw table.fault("files", fmt::format("files has {} for {}", counted(texts.size(), "pattern"),
                                           counted(recording.cameras.size(), "camera")));
  }
  for (const std::string& text : texts) {
    const auto pattern = parse_pattern(text);
    if (!pattern) throw table.fault("files", "files must hold one number each, such as \"depth-%06d.png\"");
    patterns.push_back(*pattern);
  }
  const std::uint64_t first = table.has("first") ? table.whole("first", 0, 1'000'000'000) : 0;
  if (table.has("count")) {
    const std::uint64_t count = table.whole("count", 1, most_frames);
    if (frames && count > *frames)
      throw table.fault("count", fmt::format("count is {}, but times has {}", count, counted(*frames, "line")));
    frames = count;
  }
  if (!frames) {  // as many as exist
    const auto complete = [&](std::uint64_t frame) {
      return std::all_of(patterns.begin(), patterns.end(), [&](const Pattern& p) {
        return fault_of(folder.find(p.name(first + frame), "files")).empty();
      });
    };
    frames = 0;
    while (*frames < most_frames && complete(*frames))
      ++*frames;
    constexpr std::uint64_t widest_gap = 1000;
    for (std::uint64_t gap = 1; *frames > 0 && *frames < most_frames && gap <= widest_gap; ++gap) {
      if (!complete(*frames + gap)) continue;
      log::warning(fmt::format(
          "{}: the recording ends after {}, because an image of number {} is missing, but there are images of number "
          "{}; put it there, or list the frames with [[frame]] tables",
          table.place("files"), counted(*frames, "frame"), first + *frames, first + *frames + gap));
      break;
    }
    for (std::size_t i = 0; *frames == 0 && i < patterns.size(); ++i) {
      const std::filesystem::path file = folder.find(patterns[i].name(first), "files");
      const std::string fault = fault_of(file);
      if (!fault.empty()) throw bad_input(file.string(), fault);
    }
  }
  recording.entries.resize(*frames);
  for (std::uint64_t frame = 0; frame < *frames; ++frame) {
    for (const Pattern& pattern : patterns)
      add_files(recording.entries[frame], folder, pattern.name(first + frame));
  }
}

/// Entries from `[[frame]]` tables: the names of its images, one per camera.
void list_frames(std::vector<TomlTable>& tables, ReferenceFolder& folder, Recording& recording) {
  for (TomlTable& table : tables) {
    Recording::Entry& entry = recording.entries.emplace_back();
    const std::vector<std::string> names = table.texts("files");
    if (names.size() != recording.cameras.size()) {
      throw table.fault("files", fmt::format("files names {} for {}", counted(names.size(), "image"),
                                             counted(recording.cameras.size(), "camera")));
    }
    for (const std::string& name : names)
      add_files(entry, folder, name);
    if (table.has("time_s")) {
      const double time = table.number("time_s", -most_seconds, most_seconds);
      entry.times_s.assign(recording.cameras.size(), time);
      if (recording.entries.size() > 1) {
        const auto& last = recording.entries[recording.entries.size() - 2].times_s;
        if (last.empty() || !(time > last.front())) throw table.fault("time_s", "the time does not increase");
      }
    }
    table.done();
  }
}

/// At a constant rate: frame n at n / rate.
void spread_times(double rate_hz, Recording& recording) {
  for (std::size_t i = 0; i < recording.entries.size(); ++i) {
    recording.entries[i].times_s.assign(recording.cameras.size(), static_cast<double>(i) / rate_hz);
  }
}

}  // namespace

namespace {

/// Files that other sources take.
void refuse_other_source(const std::filesystem::path& file) {
  const std::string head = InputFile(file).head(16);
  if (head.starts_with("#ROSBAG") || head.starts_with("SQLite format 3"))
    throw bad_input(file.string(), fmt::format("is a recording of RealSense Viewer: give it as bag:{}", file.string()));
  if (head.starts_with('{'))
    throw bad_input(file.string(), fmt::format("has lines of JSON: if they are hands, give joints:{}", file.string()));
}

}  // namespace

Recording load_recording(const std::filesystem::path& folder_or_toml) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(folder_or_toml, error);
  const std::filesystem::path toml = is_folder ? folder_or_toml / "recording.toml" : folder_or_toml;
  ReferenceFolder folder(toml.string(), toml.parent_path());
  if (is_folder) folder.find("recording.toml", "the recording");  // it may be a link
  refuse_other_source(toml);
  TomlTable root = TomlTable::load(toml, "a recording", {.bytes = 4u << 20});
  Recording recording;
  recording.file = toml.string();
  recording.cameras = read_cameras(root, toml.parent_path(), &folder);
  if (recording.cameras.empty()) throw root.fault("", "[[camera]] is missing: a recording needs its cameras");
  auto table = root.table("recording");
  if (!table) throw root.fault("", "[recording] is missing");

  std::vector<TomlTable> frames = root.tables("frame");
  if (frames.empty() && !table->has("files")) {
    throw table->fault("", "files is missing: one pattern per camera, or [[frame]] tables");
  }
  std::optional<Times> times;
  if (table->has("times")) times = read_times(folder.find(table->text("times"), "times"), recording.cameras.size());
  if (!frames.empty()) {
    list_frames(frames, folder, recording);
  } else {
    list_patterns(*table, folder, times ? std::optional<std::uint64_t>(times->rows.size()) : std::nullopt, recording);
    if (times) times->rows.resize(recording.entries.size());  // `count` may be smaller
  }
  if (times && times->rows.size() != recording.entries.size()) {
    throw table->fault("times", fmt::format("times has {} for {}", counted(times->rows.size(), "line"),
                                            counted(recording.entries.size(), "frame")));
  }
  const double rate_hz = table->number_or("rate_hz", recording.cameras.front().rate_hz, 1e-3, 1e6);
  table->done();
  root.done();
  if (recording.entries.empty()) throw bad_input(recording.file, "the recording has no frame");

  for (std::size_t i = 0; times && i < recording.entries.size(); ++i)
    recording.entries[i].times_s = times->rows[i];
  const bool has_times = !recording.entries.front().times_s.empty();
  if (!has_times) {
    if (!(rate_hz > 0)) throw bad_input(recording.file, "rate_hz is missing: neither times nor rate are given");
    spread_times(rate_hz, recording);
  }
  for (std::size_t i = 0; i < recording.entries.size(); ++i) {
    Recording::Entry& entry = recording.entries[i];
    if (entry.times_s.empty()) throw bad_input(recording.file, fmt::format("frame {} has no time_s", i));
    entry.time_s = *std::min_element(entry.times_s.begin(), entry.times_s.end());
    entry.sequence = times ? times->sequences[i] : i;
  }
  if (has_times) {
    std::vector<double> times_s;
    for (const Recording::Entry& entry : recording.entries)
      times_s.push_back(entry.time_s);
    if (const std::string odd = implausible_times(times_s, rate_hz); !odd.empty())
      log::warning(fmt::format("{}: {}", recording.file, odd));
  }
  return recording;
}

void read_entry(const Recording& recording, std::size_t index, FrameSet& out) {
  const Recording::Entry& entry = recording.entries.at(index);
  out.frames.resize(recording.cameras.size());
  for (std::size_t i = 0; i < recording.cameras.size(); ++i) {
    read_png16(entry.files[i], recording.cameras[i].width, recording.cameras[i].height, out.frames[i].depth);
    out.frames[i].time_s = entry.times_s[i];
  }
  out.time_s = entry.time_s;
  out.sequence = entry.sequence;
}

}  // namespace palpa::sensing
