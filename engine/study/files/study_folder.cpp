#include "study/files/study_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/system/parallel.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "study/files/events_file.hpp"
#include "study/files/finger_file.hpp"
#include "study/files/journal.hpp"
#include "study/tables/paper.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "sub-", events_end = "_events.tsv";
constexpr std::size_t most_files = 1000;  // of one participant

/// One log of a participant, and the finger's depths in its answered trials.
struct Session {
  EventsFile events;
  std::vector<DepthCourse> courses;  ///< one per answered trial; empty without a recording
  bool is_copy = false;              ///< of another participant's
};

/// A participant's folder and its content.
struct Folder {
  std::uint32_t number = 0;
  fs::path path;
  std::vector<Session> sessions;
  std::vector<std::string> left_out;
};

std::vector<Folder> participants_in(const std::string& place, std::vector<std::string>& left_out) {
  std::error_code fault;
  if (!fs::is_directory(place, fault)) {
    throw bad_input(place, fs::exists(place, fault) ? "is not a folder: give the folder of a study" : "no such folder");
  }
  std::vector<Folder> found;
  for (const fs::path& path : entries_of(place)) {
    const std::string name = path.filename().string();
    if (!name.starts_with(prefix) || !fs::is_directory(path, fault)) continue;
    if (const auto number = participant_number(name)) {
      found.push_back({.number = *number, .path = path, .sessions = {}, .left_out = {}});
    } else {
      left_out.push_back(
          fmt::format("{}: is not a participant with a number, such as sub-7; it is left out", path.string()));
    }
  }
  if (found.empty())
    throw bad_input(place, "has no participants: their logs are in folders such as sub-1/beh, sub-2/beh");
  return found;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Whether a name comes before another one, if digits in them count as numbers: run-99 before run-100.
bool comes_before(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (!is_digit(a.front()) || !is_digit(b.front())) {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
      continue;
    }
    const auto take_number = [](std::string_view& text) {
      while (text.size() > 1 && text.front() == '0' && is_digit(text[1]))
        text.remove_prefix(1);
      const auto end = std::ranges::find_if_not(text, is_digit);
      const std::string_view number = text.substr(0, static_cast<std::size_t>(end - text.begin()));
      text.remove_prefix(number.size());
      return number;
    };
    const std::string_view one = take_number(a), other = take_number(b);
    if (one != other) return std::pair(one.size(), one) < std::pair(other.size(), other);
  }
  return a.size() < b.size();
}

bool counts(const EventRow& row) {
  return row.kind == BlockKind::trial && row.status == EventStatus::answered;
}

void read_courses(const fs::path& events, Session& session, std::vector<std::string>& left_out) {
  std::string stem = events.string();
  stem.resize(stem.size() - events_end.size());
  const fs::path recording = stem + "_recording-finger_physio.tsv.gz";
  std::error_code fault;
  if (!fs::exists(recording, fault)) return;
  std::vector<TrialTime> times;
  for (const EventRow& row : session.events.rows) {
    if (counts(row)) times.push_back({row.onset_s, row.duration_s.value_or(0)});
  }
  if (times.empty()) return;
  try {
    FingerFile file = read_finger(recording, times);
    session.courses = std::move(file.courses);
    if (file.fault) left_out.push_back(*file.fault);
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    left_out.push_back(fmt::format("{}; the recording of the finger is left out", error.what()));
  }
}

/// Names what the journal of a sitting has and no log does, because the program was killed between the two: answers,
/// and the end. The logs are what is analysed.
void compare_with_journal(Folder& folder) {
  const fs::path file = folder.path / (folder.path.filename().string() + journal_end);
  std::error_code fault;
  if (!fs::is_regular_file(file, fault) || fs::file_size(file, fault) == 0) return;
  Journal journal;
  try {
    journal = read_journal(read_file(file, most_journal_bytes), file.string());
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    folder.left_out.push_back(fmt::format("{}; its answers are not compared with the logs", error.what()));
    return;
  }
  std::vector<std::vector<std::uint32_t>> runs;  // the steps that were answered in each
  std::map<std::uint32_t, std::uint32_t> by_machine;
  std::vector<std::uint32_t> stay_void;
  bool finished = false;
  for (const Entry& entry : journal.entries) {
    if (entry.kind == EntryKind::start) runs.emplace_back();
    if (entry.kind == EntryKind::answer && !runs.empty()) runs.back().push_back(entry.step.value_or(0) + 1);
    if (entry.kind == EntryKind::broken && entry.by_machine && ++by_machine[entry.step.value_or(0) + 1] > most_repeats)
      stay_void.push_back(entry.step.value_or(0) + 1);
    finished = finished || entry.kind == EntryKind::finish;
  }
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const std::string end = fmt::format("_run-{:02}{}", run + 1, events_end);
    const auto log = std::ranges::find_if(folder.sessions,
                                          [&](const Session& session) { return session.events.name.ends_with(end); });
    const bool read = log != folder.sessions.end();
    if (!read && fs::exists(folder.path / "beh" / (folder.path.filename().string() + "_task-shapes" + end), fault))
      continue;  // it is left out, and a line says why
    std::size_t logged = 0;
    if (read) {
      const EventsFile& events = log->events;
      logged = static_cast<std::size_t>(
          std::ranges::count(events.rows, EventStatus::answered, &EventRow::status) +
          // Rows that cannot be used have lines of their own.
          std::ranges::count_if(events.faults, [](const std::string& line) { return line.ends_with(" left out"); }));
    }
    if (logged >= runs[run].size()) continue;
    const auto missing = std::span(runs[run]).subspan(logged);  // a log is written in the journal's order
    folder.left_out.push_back(fmt::format(
        "{}: {} of run {} to step {} {} in no log, because the program was killed before it wrote {}: the same palpa "
        "study run or rehearse writes {}; until then {} left out",
        file.string(), missing.size() == 1 ? "the answer" : "the answers", run + 1, fmt::join(missing, ", "),
        missing.size() == 1 ? "is" : "are", missing.size() == 1 ? "it" : "them", missing.size() == 1 ? "it" : "them",
        missing.size() == 1 ? "it is" : "they are"));
  }
  if (!stay_void.empty()) {
    folder.left_out.push_back(fmt::format(
        "{}: {} {} {} void, because {} stimulus was missing, or the array failed, each time; the log has the reasons",
        file.string(), stay_void.size() == 1 ? "step" : "steps", fmt::join(stay_void, ", "),
        stay_void.size() == 1 ? "stays" : "stay", stay_void.size() == 1 ? "its" : "their"));
  }
  if (!finished && !runs.empty()) {
    folder.left_out.push_back(
        fmt::format("{}: the sitting is not finished: the same palpa study run or rehearse continues it; what was "
                    "answered so far is "
                    "analysed all the same",
                    file.string()));
  }
}

void read_participant(Folder& folder) {
  const fs::path inside = folder.path / "beh";
  std::error_code fault;
  if (fs::exists(folder.path / (folder.path.filename().string() + tombstone_end), fault)) {
    folder.left_out.push_back(fmt::format("{}: the participant withdrew", folder.path.string()));
    return;
  }
  if (!fs::is_directory(inside, fault)) {
    folder.left_out.push_back(fmt::format("{}: there is no such folder; the participant is left out", inside.string()));
    return;
  }
  std::size_t files = 0;
  std::vector<fs::path> entries = entries_of(inside);
  std::ranges::stable_sort(entries, [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().native(), b.filename().native());
  });
  for (const fs::path& path : entries) {
    const std::string name = path.filename().string();
    if (!name.ends_with(events_end)) continue;
    if (++files > most_files) throw bad_input(inside.string(), fmt::format("has more than {} logs", most_files));
    if (participant_number(name.substr(0, name.find('_'))) != folder.number) {
      folder.left_out.push_back(
          fmt::format("{}: the name is not that of a log of participant {}, such as "
                      "sub-{}_task-shapes_events.tsv; it is left out",
                      path.string(), folder.number, folder.number));
      continue;
    }
    Session session;
    try {
      session.events = read_events(path);
    } catch (const Error& error) {
      if (error.code() != Exit::bad_input) throw;
      folder.left_out.push_back(fmt::format("{}; the log is left out", error.what()));
      continue;
    }
    const auto copied = std::ranges::find_if(
        folder.sessions, [&](const Session& other) { return other.events.rows == session.events.rows; });
    if (copied != folder.sessions.end() && !session.events.rows.empty()) {
      folder.left_out.push_back(
          fmt::format("{}: has the same rows as {}; the log is left out", session.events.name, copied->events.name));
      continue;
    }
    folder.left_out.insert(folder.left_out.end(), session.events.faults.begin(), session.events.faults.end());
    read_courses(path, session, folder.left_out);
    folder.sessions.push_back(std::move(session));
  }
  compare_with_journal(folder);
  if (files == 0) {
    folder.left_out.push_back(
        fmt::format("{}: has no log, such as sub-{}_task-shapes_events.tsv; the participant is "
                    "left out",
                    inside.string(), folder.number));
  }
}

void refuse_same_numbers(const std::vector<Folder>& folders) {
  std::map<std::uint32_t, fs::path> seen;
  for (const Folder& folder : folders) {
    const auto [first, added] = seen.emplace(folder.number, folder.path);
    if (!added) {
      throw bad_input(folder.path.string(), fmt::format("participant {} is also in {}: give each participant a number "
                                                        "of their own",
                                                        folder.number, first->second.string()));
    }
  }
}

/// The numbers of participants, as "1, 2, 3 and 4 more".
std::string numbers_text(const std::vector<std::uint32_t>& numbers) {
  constexpr std::size_t most = 10;
  const std::size_t shown = numbers.size() > most ? most - 1 : numbers.size();
  const std::string text = fmt::format("{}", fmt::join(std::span(numbers).first(shown), ", "));
  return shown == numbers.size() ? text : fmt::format("{} and {} more", text, numbers.size() - shown);
}

/// A line if the logs name more than one plan; else nothing.
std::optional<std::string> differing_plans(const std::vector<Folder>& folders) {
  std::vector<std::pair<std::string, std::vector<std::uint32_t>>> plans;
  for (const Folder& folder : folders) {
    for (const Session& session : folder.sessions) {
      const std::string& plan = session.events.plan_sha256;
      if (plan.empty()) continue;
      auto found = std::ranges::find(plans, plan, [](const auto& one) { return one.first; });
      if (found == plans.end()) found = plans.emplace(plans.end(), plan, std::vector<std::uint32_t>());
      if (found->second.empty() || found->second.back() != folder.number) found->second.push_back(folder.number);
    }
  }
  if (plans.size() < 2) return std::nullopt;
  std::string text;
  for (const auto& [plan, numbers] : plans) {
    text += fmt::format("{}{}: {} {}", text.empty() ? "" : "; ", plan.substr(0, 8),
                        numbers.size() == 1 ? "participant" : "participants", numbers_text(numbers));
  }
  return fmt::format(
      "the participants had different plans, by PlanSha256 of their logs ({}); they are analysed as one "
      "study all the same",
      text);
}

/// Leaves out logs with the same rows as a log of an earlier participant: onsets are measured. Those of rehearsals are
/// not, and logs without times of answers may have planned ones, so these are only reported.
void leave_out_copies(std::vector<Folder>& folders) {
  std::map<std::pair<std::size_t, double>, std::vector<std::pair<std::uint32_t, const EventsFile*>>> seen;
  for (Folder& folder : folders) {
    for (Session& session : folder.sessions) {
      const EventsFile& events = session.events;
      if (std::ranges::none_of(events.rows, counts)) continue;
      auto& alike = seen[{events.rows.size(), events.rows.back().onset_s}];
      const auto original = std::ranges::find_if(
          alike, [&](const auto& other) { return other.first != folder.number && other.second->rows == events.rows; });
      if (original == alike.end()) {
        alike.emplace_back(folder.number, &events);
        continue;
      }
      session.is_copy = !events.rehearsal && std::ranges::any_of(events.rows, [](const EventRow& row) {
        return counts(row) && row.response_s.has_value();
      });
      folder.left_out.push_back(fmt::format(
          "{}: has the same rows as {} of participant {}; {}", events.name, original->second->name, original->first,
          session.is_copy ? "the log is left out" : "it is analysed all the same: see whether it is a copy"));
    }
  }
  for (Folder& folder : folders)
    std::erase_if(folder.sessions, [](const Session& session) { return session.is_copy; });
}

/// The names in the order of `first`, then by name.
std::vector<std::string> ordered(std::vector<std::string> names, const std::vector<std::string>& first) {
  const auto place = [&](const std::string& name) { return std::ranges::find(first, name) - first.begin(); };
  std::ranges::sort(names, [&](const std::string& a, const std::string& b) {
    return std::pair(place(a), std::string_view(a)) < std::pair(place(b), std::string_view(b));
  });
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// The shapes of the study: those that most sidecars name, the first of them if there are as many of others; otherwise
/// all that were shown. Logs of other shapes are left out.
std::vector<std::string> agree_on_shapes(std::vector<Folder>& folders) {
  /// Logs that name the same shapes, in whatever order.
  struct Told {
    const EventsFile* first = nullptr;
    std::vector<std::string> names{};
    std::size_t logs = 0;
  };
  std::vector<Told> told;
  std::vector<std::string> shown;
  for (const Folder& folder : folders) {
    for (const Session& session : folder.sessions) {
      if (!session.events.shapes.empty()) {
        std::vector<std::string> names = ordered(session.events.shapes, {});
        auto same = std::ranges::find(told, names, &Told::names);
        if (same == told.end()) same = told.insert(same, Told{.first = &session.events, .names = std::move(names)});
        ++same->logs;
      }
      for (const EventRow& row : session.events.rows) {
        if (counts(row) && (shown.empty() || shown.back() != row.shape)) shown.push_back(row.shape);
      }
    }
  }
  if (told.empty()) return ordered(std::move(shown), paper_shapes());
  const Told& most = *std::ranges::max_element(told, {}, &Told::logs);  // the first of several
  std::vector<std::string> shapes = most.first->shapes;
  const std::string teller = most.first->name;
  const auto only_in = [](const std::vector<std::string>& some, const std::vector<std::string>& others) {
    std::vector<std::string> only;
    std::ranges::set_difference(some, others, std::back_inserter(only));
    return only.empty() ? std::string("none") : fmt::format("{}", fmt::join(only, ", "));
  };
  for (Folder& folder : folders) {
    std::erase_if(folder.sessions, [&](const Session& session) {
      const std::vector<std::string> names = ordered(session.events.shapes, {});
      if (names.empty() || names == most.names) return false;
      folder.left_out.push_back(
          fmt::format("{}: its shapes are {}, but those of {} are {} (only here: {}; missing here: {}); the log is "
                      "left out",
                      session.events.name, fmt::join(session.events.shapes, ", "), teller, fmt::join(shapes, ", "),
                      only_in(names, most.names), only_in(most.names, names)));
      return true;
    });
  }
  return shapes;
}

std::optional<std::uint32_t> place_in(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - names.begin());
}

void add_course(std::vector<DepthCourse>& courses, std::size_t place, std::size_t all, const DepthCourse& course) {
  if (course.empty()) return;
  courses.resize(all);
  DepthCourse& into = courses[place];
  if (into.samples.size() < course.samples.size()) {
    into.samples.resize(course.samples.size(), 0);
    into.sum_m.resize(course.samples.size(), 0);
  }
  for (std::size_t bin = 0; bin < course.samples.size(); ++bin) {
    into.samples[bin] += course.samples[bin];
    into.sum_m[bin] += course.sum_m[bin];
  }
}

Participant assemble(Folder& folder, const Study& study) {
  Participant participant{.number = folder.number, .place = folder.path.string()};
  participant.voids.resize(study.methods.size(), 0);
  participant.void_shapes.resize(study.methods.size() * study.shapes.size(), 0);
  for (const Session& session : folder.sessions) {
    std::size_t course = 0;
    for (const EventRow& row : session.events.rows) {
      if (row.kind == BlockKind::trial && row.status == EventStatus::broken) {
        const auto method = place_in(study.methods, row.method), shape = place_in(study.shapes, row.shape);
        if (method) ++participant.voids[*method];
        if (method && shape) ++participant.void_shapes[*method * study.shapes.size() + *shape];
      }
      if (row.kind == BlockKind::familiarise && row.status == EventStatus::answered) {
        ++participant.asked;
        participant.unfelt += row.answer == "no" ? 1 : 0;
      }
      if (!counts(row)) continue;
      const std::size_t own_course = course++;
      const auto method = place_in(study.methods, row.method);
      const auto shape = place_in(study.shapes, row.shape), answer = place_in(study.shapes, row.answer);
      if (!shape || !answer) {
        folder.left_out.push_back(fmt::format(
            "{}: line {}: the {} '{}' is not one of {}; the row is left out", session.events.name, row.line,
            shape ? "answer" : "shape", printable(shape ? row.answer : row.shape, 40), fmt::join(study.shapes, ", ")));
        continue;
      }
      participant.trials.push_back({*method, *shape, *answer, row.response_s});
      if (own_course < session.courses.size()) {
        add_course(participant.depths, *method * study.shapes.size() + *shape,
                   study.methods.size() * study.shapes.size(), session.courses[own_course]);
      }
    }
  }
  if (participant.trials.empty() && !folder.sessions.empty()) {
    const bool planned = std::ranges::any_of(folder.sessions, [](const Session& session) {
      return std::ranges::find(session.events.rows, BlockKind::trial, &EventRow::kind) != session.events.rows.end();
    });
    folder.left_out.push_back(fmt::format("{}: {}has no answered trial; the participant is left out", participant.place,
                                          planned ? "" : "has no row of a block 'trial', so it "));
  }
  return participant;
}

}  // namespace

std::optional<std::uint32_t> participant_number(std::string_view name) {
  if (!name.starts_with(prefix)) return std::nullopt;
  return parse_whole<std::uint32_t>(name.substr(prefix.size()));
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code fault;
  for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault))
    entries.push_back(at->path());
  if (fault) throw bad_input(folder.string(), "cannot be read: " + fault.message());
  std::ranges::sort(entries);
  return entries;
}

Study read_study(std::span<const std::string> places) {
  Study study;
  std::vector<Folder> folders;
  for (const std::string& place : places) {
    for (Folder& folder : participants_in(place, study.left_out))
      folders.push_back(std::move(folder));
  }
  refuse_same_numbers(folders);
  if (folders.size() > most_participants) {
    throw bad_input(places[0],
                    fmt::format("has {} participants, at most {} are analysed", folders.size(), most_participants));
  }
  std::ranges::sort(folders, {}, &Folder::number);
  parallel_chunks(folders.size(), 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      read_participant(folders[i]);
  });

  leave_out_copies(folders);
  study.shapes = agree_on_shapes(folders);
  if (std::optional<std::string> line = differing_plans(folders)) study.left_out.push_back(std::move(*line));
  for (const Folder& folder : folders) {
    for (const Session& session : folder.sessions) {
      study.least_trials = std::max(study.least_trials, session.events.least_trials);
      for (const EventRow& row : session.events.rows) {
        if (counts(row) && !place_in(study.methods, row.method)) study.methods.push_back(row.method);
      }
    }
  }
  study.methods = ordered(std::move(study.methods), {"single-focus"});
  if (study.methods.size() > most_methods || study.shapes.size() > most_shapes) {
    throw bad_input(places[0], fmt::format("has {} methods and {} shapes; at most {} and {} are analysed",
                                           study.methods.size(), study.shapes.size(), most_methods, most_shapes));
  }
  for (Folder& folder : folders) {
    Participant participant = assemble(folder, study);
    study.left_out.insert(study.left_out.end(), folder.left_out.begin(), folder.left_out.end());
    if (!participant.trials.empty()) study.participants.push_back(std::move(participant));
  }
  if (study.participants.empty()) {
    // The first line says what is wrong with the only, or the first, log, unless that is analysed all the same.
    const auto reason = std::ranges::find_if(study.left_out, [](const std::string& line) {
      return line.find("analysed all the same") == std::string::npos;
    });
    throw bad_input(places[0], reason == study.left_out.end() ? "has no answered trial"
                                                              : fmt::format("nothing can be analysed: {}", *reason));
  }
  return study;
}

}  // namespace palpa::study
