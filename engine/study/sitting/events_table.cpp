#include "study/sitting/events_table.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <utility>

#include "base/files/json_writer.hpp"
#include "base/files/without_folders.hpp"
#include "study/files/events_file.hpp"
#include "study/files/gzip.hpp"
#include "study/files/sidecar.hpp"
#include "study/sitting/ear_level.hpp"

namespace palpa::study {
namespace {

/// A step that was begun, and what became of it.
struct Begun {
  std::uint32_t step = 0;
  std::int64_t begin_ns = 0;
  std::optional<std::int64_t> end_ns{};  ///< of its touch, or of the break
  std::optional<std::int64_t> answer_ns{};
  EventStatus status = EventStatus::broken;
  std::string answer{}, why{};
  double deep_s = 0;
  std::optional<TouchLosses> losses{};  ///< of its touch
};

/// What the log says of a step that was under way when the program ended, however it did.
constexpr const char* program_ended = "the program ended";

std::vector<Begun> begun_in(std::span<const Entry> run) {
  std::vector<Begun> all;
  for (const Entry& entry : run) {
    if (entry.kind == EntryKind::begin) {
      all.push_back({.step = entry.step.value_or(0), .begin_ns = entry.at_ns, .why = program_ended});
      continue;
    }
    if (all.empty()) continue;
    Begun& last = all.back();
    switch (entry.kind) {
      case EntryKind::touched:
        last.end_ns = entry.at_ns;
        last.deep_s = entry.deep_s.value_or(0);
        if (entry.stimulus) last.losses = entry.stimulus->losses;
        break;
      case EntryKind::answer:
        last.answer_ns = entry.at_ns;
        last.answer = entry.text;
        last.status = EventStatus::answered;
        last.why.clear();
        break;
      case EntryKind::done:
        if (!last.end_ns) last.end_ns = entry.at_ns;
        last.status = EventStatus::done;
        last.why.clear();
        break;
      case EntryKind::broken:
        if (!last.end_ns) last.end_ns = entry.at_ns;
        last.why = entry.text;
        break;
      default:
        break;
    }
  }
  return all;
}

std::string seconds(std::int64_t ns) {
  return fmt::format("{:.6f}", static_cast<double>(ns) * 1e-9);
}

std::string cell(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return text.empty() ? std::string(not_available) : text;
}

const Entry& start_of(std::span<const Entry> run) {
  return run.front();
}

/// Whether the answer was right; nothing for questions without a right answer.
std::optional<bool> is_right(const StudyPlan& plan, const Step& step, const Begun& begun) {
  if (begun.status != EventStatus::answered || !asks(plan.blocks[step.block].kind)) return std::nullopt;
  return begun.answer == plan.shapes[*step.shape].name;
}

void column(JsonWriter& json, const char* name, const char* what, const char* unit = "") {
  json.key(name).begin_object(JsonWriter::Style::line).member("Description", what);
  if (*unit != '\0') json.member("Units", unit);
  json.end_object();
}

}  // namespace

std::vector<std::span<const Entry>> runs_of(std::span<const Entry> entries) {
  std::vector<std::span<const Entry>> runs;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= entries.size(); ++i) {
    if (i < entries.size() && entries[i].kind != EntryKind::start) continue;
    runs.push_back(entries.subspan(begin, i - begin));
    begin = i;
  }
  return runs;
}

std::vector<PlayedStep> played_steps(const StudyPlan& plan, std::span<const Step> steps,
                                     std::span<const Entry> entries) {
  std::vector<PlayedStep> played;
  std::int64_t begin_ns = 0;
  std::optional<std::string> chosen;
  for (const Entry& entry : entries) {
    if (entry.kind == EntryKind::begin) {
      begin_ns = entry.at_ns;
      chosen.reset();
    }
    if (entry.kind == EntryKind::choose) chosen = entry.text;
    if (entry.kind != EntryKind::touched || !entry.step || *entry.step >= steps.size()) continue;
    const std::uint32_t shape = steps[*entry.step].shape.value_or(0);
    played.push_back({&entry, begin_ns, chosen.value_or(plan.shapes[shape].name)});
  }
  return played;
}

std::string events_table(const StudyPlan& plan, std::span<const Step> steps, std::span<const Entry> run) {
  std::string table =
      "onset\tduration\ttrial_type\tmethod\tshape\tanswer\tcorrect\tresponse_time\tstatus\tdeep_time\t"
      "step\treason\tlost_drives\tskipped_drives\toutdated_frames\tthinned_frames\tleft_out_frames\t"
      "skin_frames\n";
  for (const Begun& begun : begun_in(run)) {
    const Step& step = steps[begun.step];
    const PlanBlock& block = plan.blocks[step.block];
    // In the free exploration, the participant chose the shapes; the stimuli say which.
    const bool named = step.shape && block.kind != BlockKind::free;
    const std::optional<bool> right = is_right(plan, step, begun);
    const auto number = [&](std::uint64_t TouchLosses::*which) {
      return begun.losses ? std::to_string((*begun.losses).*which) : std::string(not_available);
    };
    fmt::format_to(
        std::back_inserter(table), "{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{:.3f}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\n",
        seconds(begun.begin_ns), begun.end_ns ? seconds(*begun.end_ns - begun.begin_ns) : not_available,
        word_of(block_words, block.kind), plan.methods[step.method].name,
        named ? plan.shapes[*step.shape].name : std::string(not_available), cell(begun.answer),
        !right   ? not_available
        : *right ? std::string_view("true")
                 : std::string_view("false"),
        begun.answer_ns && begun.end_ns ? seconds(*begun.answer_ns - *begun.end_ns) : not_available,
        word_of(status_words, begun.status), begun.deep_s, begun.step + 1, cell(begun.why),
        number(&TouchLosses::drives), number(&TouchLosses::skipped_drives), number(&TouchLosses::outdated_frames),
        number(&TouchLosses::thinned_frames), number(&TouchLosses::left_out_frames), number(&TouchLosses::skin_frames));
  }
  return table;
}

std::string events_sidecar(const StudyPlan& plan, std::uint32_t participant, std::span<const Entry> run,
                           const std::string& table, bool ended) {
  const Entry& start = start_of(run);
  JsonWriter json;
  json.begin_object()
      .member("PalpaStudyVersion", log_version)
      .member("TaskName", "shapes")
      .member("Participant", participant)
      .member("StartTimeUtc", start.text)
      .member("PalpaVersion", start.version)
      .member("PlanTitle", plan.title)
      .member("PlanSha256", plan.sha256)
      .member("LeastTrials", plan.counts.least_trials);
  if (start.rehearsal) json.member("Rehearsal", true);
  if (!start.masking.empty()) json.member("Masking", start.masking);
  if (!start.backend.empty()) json.member("Backend", start.backend);
  if (ended) json.member("EventsCrc32", fmt::format("{:08x}", crc32_of(table)));
  for (const Entry& entry : run) {
    if (entry.kind != EntryKind::level) continue;
    json.key("SoundLevel").begin_object(JsonWriter::Style::line);
    const bool measured = plan.level.measured_db.has_value();
    if (entry.level_db) json.member(measured ? "MeasuredPeakDb" : "PredictedPeakDb", *entry.level_db);
    if (entry.dose_db) json.member(measured ? "MeasuredEquivalentDb" : "PredictedEquivalentDb", *entry.dose_db);
    json.member("LimitDb", plan.level.limit_db);
    if (const double sounding_s = sounded_s(run); sounding_s > 0) {
      json.member("SoundedSeconds", sounding_s);
      if (entry.level_db) json.member("SoundedEquivalentDb", equivalent_db(*entry.level_db, sounding_s));
    }
    if (!entry.text.empty()) json.member("OverrideSignedBy", entry.text);
    json.end_object();
  }
  column(json, "onset", "when the step began, on a clock that only goes forward, from the start of the program", "s");
  column(json, "duration", "from the onset to the end of the touch", "s");
  column(json, "trial_type", "the kind of the block");
  column(json, "method", "the method of the plan");
  json.key("shape").begin_object().member("Description", "the shape that was touched").key("Levels").begin_object();
  for (const PlanShape& shape : plan.shapes)
    json.member(shape.name, "");
  json.end_object().end_object();
  column(json, "answer", "the answer of the participant");
  column(json, "correct", "whether the answer was right, if there is a right one");
  column(json, "response_time", "from the end of the touch to the answer", "s");
  column(json, "status", "answered, done, or void: broken off, or without its stimulus; repeated later");
  column(json, "deep_time", "how long nothing was played because a point was too deep", "s");
  column(json, "step", "the number in the participant's order; a repeated step has the same number");
  column(json, "reason", "why the step is void");
  column(json, "lost_drives", "how many drives that sound the array never got");
  column(json, "skipped_drives", "how many drives were never sent, because the program was too late");
  column(json, "outdated_frames", "how many frames with skin over the object were too late to be played");
  column(json, "thinned_frames", "how many of them were played with fewer pixels or foci, because time was short");
  column(json, "left_out_frames", "how many of them were never played: no drive of theirs reached the array");
  column(json, "skin_frames",
         "how many frames had skin over the object; with more than a tenth of them outdated, thinned or left out, a "
         "touch is void");
  json.end_object();
  return json.take();
}

std::string stimuli_json(const StudyPlan& plan, std::span<const Step> steps, std::span<const Entry> run) {
  const Entry& start = start_of(run);
  JsonWriter json;
  json.begin_object()
      .member("PalpaVersion", start.version)
      .member("PlanSha256", plan.sha256)
      .key("touches")
      .begin_array(JsonWriter::Style::rows);
  for (const auto& [touched, begin_ns, shape] : played_steps(plan, steps, run)) {
    const Entry& entry = *touched;
    const PlanMethod& method = plan.methods[steps[*entry.step].method];
    json.begin_object()
        .member("step", *entry.step + 1)
        .member("onset_s", static_cast<double>(begin_ns) * 1e-9)
        .member("end_s", static_cast<double>(entry.at_ns) * 1e-9)
        .member("shape", shape)
        .member("method", method.name)
        .member("foci_method", word_of(touch::method_words, method.method))
        .member("foci", method.foci)
        .member("dwell_s", method.dwell_s)
        .member("modulation_hz", method.modulation_hz)
        .member("delta_m", method.delta_m)
        .member("layout", without_folders(entry.stimulus && !entry.stimulus->layout.empty() ? entry.stimulus->layout
                                                                                            : method.layout));
    if (method.stride) json.member("stride", *method.stride);
    if (method.amplitude) json.member("amplitude", word_of(array::weighting_words, *method.amplitude));
    if (method.solver) json.member("solver", word_of(array::solver_words, *method.solver));
    if (method.constraint) json.member("constraint", word_of(array::constraint_words, *method.constraint));
    if (entry.stimulus) {
      json.member("ceiling", entry.stimulus->ceiling);
      if (!entry.stimulus->model_sha256.empty()) json.member("model_sha256", entry.stimulus->model_sha256);
      if (!entry.stimulus->foci_file.empty()) json.member("foci_file", entry.stimulus->foci_file);
      if (!entry.stimulus->drives_sha256.empty())
        json.member("drives", entry.stimulus->drives).member("drives_sha256", entry.stimulus->drives_sha256);
    }
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

}  // namespace palpa::study
