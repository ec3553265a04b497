#include "session/links/foci_file.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/text.hpp"
#include "session/links/foci_link.hpp"

namespace palpa::session {
namespace {

class JsonFile final : public FociFile {
 public:
  JsonFile(const std::string& file, const LinkSetting& setting)
      : out_(file), solid_names_(setting.solid_names.begin(), setting.solid_names.end()) {
    out_.write(fmt::format("{{\"slot_s\":{},\"frames\":[", setting.slot_s));
  }
  void plan(const PlayedPlan& plan) override {
    if (!write_foci_line(plan.schedule, plan.slots, solid_names_, json_) && !std::exchange(told_, true))
      warn_of_cut_gains("--foci");
    std::string_view line = json_.finish();
    line.remove_prefix(1);  // its brace
    line.remove_suffix(1);  // and its newline
    out_.write(fmt::format("{}{{\"slot\":{},{}", std::exchange(between_, ",\n"), plan.slots.from, line));
  }
  void commit() override {
    out_.write("\n]}\n");
    out_.finish();
  }

 private:
  OutputFile out_;
  std::vector<std::string> solid_names_;
  JsonWriter json_;
  const char* between_ = "\n";
  bool told_ = false;  ///< of gains that are cut
};

class CsvFile final : public FociFile {
 public:
  CsvFile(const std::string& file, const LinkSetting& setting) : out_(file) {
    out_.write("slot,time_s,finger,solid,focus,x,y,z,gain\n");
    for (const std::string& name : setting.solid_names)
      solid_cells_.push_back(csv_cell(name));
  }
  void plan(const PlayedPlan& plan) override {
    text_.clear();
    for (std::uint32_t v = 0; v < plan.schedule.voice_count; ++v) {
      const array::Voice& voice = plan.schedule.voices[v];
      const std::string_view solid =
          voice.solid < solid_cells_.size() ? std::string_view(solid_cells_[voice.solid]) : "";
      for (std::size_t n = 0; n < voice.foci.size(); ++n) {
        const glm::vec3 focus(voice.foci[n]);
        fmt::format_to(std::back_inserter(text_), "{},{},{},{},{},{},{},{},{}\n", plan.slots.from, plan.schedule.time_s,
                       voice.id, solid, n, focus.x, focus.y, focus.z, voice.gain);
      }
    }
    out_.write(text_);
  }
  void commit() override { out_.finish(); }

 private:
  OutputFile out_;
  std::vector<std::string> solid_cells_;
  std::string text_;
};

bool is_csv(const std::string& file) {
  return file.ends_with(".csv");
}

}  // namespace

void check_foci_file(const std::string& file) {
  if (is_csv(file) || file.ends_with(".json") || file == "-") return;
  throw bad_usage(fmt::format("--foci {}: give a name that ends in .csv or .json, or - for JSON on stdout", file));
}

std::unique_ptr<FociFile> open_foci_file(const std::string& file, const LinkSetting& setting) {
  check_foci_file(file);
  if (is_csv(file)) return std::make_unique<CsvFile>(file, setting);
  return std::make_unique<JsonFile>(file, setting);
}

}  // namespace palpa::session
