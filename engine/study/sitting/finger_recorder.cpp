#include "study/sitting/finger_recorder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <string_view>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "study/files/gzip.hpp"

namespace palpa::study {
namespace {

constexpr const char* recording = "_recording-finger_physio";

void describe(JsonWriter& json, const char* name, const char* what) {
  json.key(name).begin_object(JsonWriter::Style::line).member("Description", what).member("Units", "m").end_object();
}

std::string finger_sidecar() {
  JsonWriter json;
  json.begin_object()
      .member("SamplingFrequency", FingerRecorder::rate_hz)
      .member("StartTime", 0.0)
      .key("Columns")
      .begin_array(JsonWriter::Style::line);
  for (const char* name : {"depth", "x", "y", "z"})
    json.value(name);
  json.end_array();
  describe(json, "depth", "how far the lowest captured point over the object is below the top of the object");
  for (const char* name : {"x", "y", "z"})
    describe(json, name, "this point, in the world");
  json.end_object();
  return json.take();
}

}  // namespace

FingerRecorder::FingerRecorder(const ParticipantFolder& folder, std::uint32_t run)
    : file_(open_to_append(folder.file(run, fmt::format("{}.tsv.gz", recording)))) {
  if (std::filesystem::file_size(file_.name()) > 0)
    throw failure(file_.name() + ": is there already, and is not replaced");
  write_file(folder.file(run, fmt::format("{}.json", recording)), finger_sidecar());
}

/// Row n is that of the time n / rate_hz.
void FingerRecorder::rows_until(double time_s) {
  for (; static_cast<double>(next_row_) / rate_hz < time_s; ++next_row_) {
    const double row_s = static_cast<double>(next_row_) / rate_hz;
    if (!sample_ || row_s < sample_s_ || row_s > sample_s_ + longest_s) {
      rows_ += "n/a\tn/a\tn/a\tn/a\n";
      continue;
    }
    fmt::format_to(std::back_inserter(rows_), "{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\n", sample_->depth_m, sample_->point.x,
                   sample_->point.y, sample_->point.z);
  }
}

void FingerRecorder::add(double time_s, const std::optional<FingerSample>& sample) {
  rows_until(time_s);
  sample_s_ = time_s;
  sample_ = sample;
}

void FingerRecorder::flush(double time_s) {
  rows_until(time_s);
  if (rows_.empty()) return;
  file_.write(gzip_of(rows_), true);
  rows_.clear();
}

}  // namespace palpa::study
