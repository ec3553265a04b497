#include "study/files/journal.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "study/files/gzip.hpp"

namespace palpa::study {
namespace {

using Json = nlohmann::json;

constexpr std::size_t digits = 8;

std::string digits_for(std::string_view before, std::string_view json) {
  return fmt::format("{:08x}", crc32_of(std::string(before) + std::string(json)));
}

std::string line_of(JsonWriter& writer, std::string_view before) {
  std::string json(writer.finish());
  json.pop_back();  // the line's end, which stands after the digits
  return json + '\t' + digits_for(before, json) + '\n';
}

template <typename T>
T number_or(const Json& object, const char* key, T fallback) {
  const auto found = object.find(key);
  if (found == object.end()) return fallback;
  return found->get<T>();
}

std::optional<double> maybe_number(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  return found->get<double>();
}

JournalHead head_of(const Json& object) {
  return {.participant = object.at("participant").get<std::uint32_t>(),
          .plan_sha256 = object.at("plan_sha256").get<std::string>()};
}

Entry entry_of(const Json& object) {
  const std::optional<EntryKind> kind = value_of(entry_words, object.at("what").get<std::string>());
  if (!kind) throw failure("what happened is unknown");
  Entry entry{.kind = *kind, .at_ns = object.at("at_ns").get<std::int64_t>()};
  if (object.contains("step")) entry.step = object["step"].get<std::uint32_t>();
  entry.by_machine = number_or(object, "by_machine", false);
  entry.text = number_or<std::string>(object, "text", "");
  entry.version = number_or<std::string>(object, "version", "");
  entry.rehearsal = number_or(object, "rehearsal", false);
  entry.masking = number_or<std::string>(object, "masking", "");
  entry.backend = number_or<std::string>(object, "backend", "");
  entry.accepted = number_or(object, "accepted", false);
  entry.depth_frames = number_or(object, "depth_frames", false);
  entry.sounded_s = maybe_number(object, "sounded_s");
  entry.deep_s = maybe_number(object, "deep_s");
  entry.level_db = maybe_number(object, "level_db");
  entry.dose_db = maybe_number(object, "dose_db");
  if (const auto found = object.find("stimulus"); found != object.end()) {
    entry.stimulus = Stimulus{.model_sha256 = number_or<std::string>(*found, "model_sha256", ""),
                              .ceiling = found->at("ceiling").get<double>(),
                              .foci_file = number_or<std::string>(*found, "foci_file", ""),
                              .drives_sha256 = number_or<std::string>(*found, "drives_sha256", ""),
                              .drives = number_or<std::uint64_t>(*found, "drives", 0),
                              .layout = number_or<std::string>(*found, "layout", "")};
    if (const auto losses = found->find("losses"); losses != found->end()) {
      entry.stimulus->losses = TouchLosses{.drives = number_or<std::uint64_t>(*losses, "drives", 0),
                                           .skipped_drives = number_or<std::uint64_t>(*losses, "skipped_drives", 0),
                                           .outdated_frames = number_or<std::uint64_t>(*losses, "outdated_frames", 0),
                                           .thinned_frames = number_or<std::uint64_t>(*losses, "thinned_frames", 0),
                                           .left_out_frames = number_or<std::uint64_t>(*losses, "left_out_frames", 0),
                                           .skin_frames = number_or<std::uint64_t>(*losses, "skin_frames", 0)};
    }
  }
  return entry;
}

void write_stimulus(JsonWriter& json, const Stimulus& stimulus) {
  json.key("stimulus").begin_object().member("ceiling", stimulus.ceiling);
  if (!stimulus.model_sha256.empty()) json.member("model_sha256", stimulus.model_sha256);
  if (!stimulus.foci_file.empty()) json.member("foci_file", stimulus.foci_file);
  if (!stimulus.drives_sha256.empty())
    json.member("drives_sha256", stimulus.drives_sha256).member("drives", stimulus.drives);
  if (!stimulus.layout.empty()) json.member("layout", stimulus.layout);
  if (stimulus.losses) {
    json.key("losses")
        .begin_object()
        .member("drives", stimulus.losses->drives)
        .member("skipped_drives", stimulus.losses->skipped_drives)
        .member("outdated_frames", stimulus.losses->outdated_frames)
        .member("thinned_frames", stimulus.losses->thinned_frames)
        .member("left_out_frames", stimulus.losses->left_out_frames)
        .member("skin_frames", stimulus.losses->skin_frames)
        .end_object();
  }
  json.end_object();
}

}  // namespace

double sounded_s(std::span<const Entry> entries) {
  double sum = 0;
  for (const Entry& entry : entries)
    sum += entry.sounded_s.value_or(0);
  return sum;
}

std::string head_line(const JournalHead& head) {
  JsonWriter json;
  json.begin_object(JsonWriter::Style::compact)
      .member("palpa_journal", journal_version)
      .member("participant", head.participant)
      .member("plan_sha256", head.plan_sha256)
      .end_object();
  return line_of(json, "");
}

std::string entry_line(const Entry& entry, std::string_view before) {
  JsonWriter json;
  json.begin_object(JsonWriter::Style::compact)
      .member("what", word_of(entry_words, entry.kind))
      .member("at_ns", entry.at_ns);
  if (entry.step) json.member("step", *entry.step);
  if (entry.by_machine) json.member("by_machine", true);
  if (!entry.text.empty()) json.member("text", entry.text);
  if (!entry.version.empty()) json.member("version", entry.version);
  if (entry.rehearsal) json.member("rehearsal", true);
  if (!entry.masking.empty()) json.member("masking", entry.masking);
  if (!entry.backend.empty()) json.member("backend", entry.backend);
  if (entry.kind == EntryKind::consent)
    json.member("accepted", entry.accepted).member("depth_frames", entry.depth_frames);
  if (entry.sounded_s) json.member("sounded_s", *entry.sounded_s);
  if (entry.deep_s) json.member("deep_s", *entry.deep_s);
  if (entry.level_db) json.member("level_db", *entry.level_db);
  if (entry.dose_db) json.member("dose_db", *entry.dose_db);
  if (entry.stimulus) write_stimulus(json, *entry.stimulus);
  json.end_object();
  return line_of(json, before);
}

std::string_view digits_of(std::string_view line) {
  return line.substr(line.size() - digits - 1, digits);
}

Journal read_journal(std::string_view text, const std::string& name) {
  Journal journal;
  std::size_t number = 0;
  for (;;) {
    const std::size_t end = text.find('\n', journal.whole);
    if (end == std::string_view::npos) return journal;
    ++number;
    const std::string_view line = text.substr(journal.whole, end - journal.whole);
    const std::size_t tab = line.rfind('\t');
    if (tab == std::string_view::npos || digits_for(journal.last_digits, line.substr(0, tab)) != line.substr(tab + 1)) {
      throw bad_input(name, fmt::format("line {} is damaged or was changed: its checksum does not fit. palpa does not "
                                        "continue this participant; what was written before can be analysed",
                                        number));
    }
    const Json object = Json::parse(line.substr(0, tab), nullptr, false);
    try {
      if (number == 1) {
        if (const auto version = object.at("palpa_journal").get<std::uint64_t>(); version != journal_version)
          throw bad_input(name, fmt::format("has version {}, this palpa reads version {}", version, journal_version));
        journal.head = head_of(object);
      } else {
        journal.entries.push_back(entry_of(object));
      }
    } catch (const Json::exception&) {
      throw bad_input(name, fmt::format("line {} is not an entry of a journal", number));
    } catch (const Error& error) {
      if (error.code() == Exit::bad_input) throw;
      throw bad_input(name, fmt::format("line {} is not an entry of a journal: {}", number, error.what()));
    }
    journal.last_digits = line.substr(tab + 1);
    journal.whole = end + 1;
  }
}

}  // namespace palpa::study
