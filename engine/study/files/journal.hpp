// The journal of a sitting: everything that happens from a participant's consent to the end, one line per entry. It
// only grows, and it is the state of the sitting: a program that continues after a crash knows what is in the journal,
// and nothing else. The log of trials (_events.tsv) is written from it.
//
// A line is a JSON object, a tab, eight hexadecimal digits and LF. The digits are the CRC-32 of the digits of the line
// before (of the first line: of nothing) followed by the JSON. A changed, removed or exchanged line therefore shows.
// Whatever follows the last LF was cut off while it was written, and does not count.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/words.hpp"

namespace palpa::study {

/// The version of journals that palpa reads and writes.
inline constexpr std::uint64_t journal_version = 1;

/// Larger files are no journals.
inline constexpr std::uint64_t most_journal_bytes = 64u << 20;

/// The first line.
struct JournalHead {
  std::uint32_t participant = 0;
  std::string plan_sha256{};
  bool operator==(const JournalHead&) const = default;
};

enum class EntryKind {
  start,    ///< the program was started: times count from here. Whatever was open before is void
  consent,  ///< the participant's answers to the consent pages
  level,    ///< the sound level at the ears, predicted or measured
  begin,    ///< a step begins: its touch, or its break
  touched,  ///< a touch has ended
  choose,   ///< the participant chose a shape in the free exploration
  answer,   ///< the step is complete, with its answer
  done,     ///< the step is complete, without an answer
  broken,   ///< the step was broken off: it is void and will be repeated
  pause,    ///< the experimenter, the participant or a fault stopped the sitting
  resume,
  stop,    ///< the sitting was stopped on purpose; the next start continues it
  finish,  ///< all steps are complete, or the participant did not consent
};
inline constexpr Word<EntryKind> entry_words[] = {
    {"start", EntryKind::start},   {"consent", EntryKind::consent}, {"level", EntryKind::level},
    {"begin", EntryKind::begin},   {"touched", EntryKind::touched}, {"choose", EntryKind::choose},
    {"answer", EntryKind::answer}, {"done", EntryKind::done},       {"void", EntryKind::broken},
    {"pause", EntryKind::pause},   {"resume", EntryKind::resume},   {"stop", EntryKind::stop},
    {"finish", EntryKind::finish}};

/// How often a step is repeated that a machine broke off, or that lacked its stimulus. Then it stays void.
inline constexpr std::uint32_t most_repeats = 2;

/// What a touch lost because the machine or the array could not follow.
struct TouchLosses {
  std::uint64_t drives = 0;           ///< that sound and that the array never got
  std::uint64_t skipped_drives = 0;   ///< that were never sent, because the program was too late
  std::uint64_t outdated_frames = 0;  ///< whose drives came too late to sound
  std::uint64_t thinned_frames = 0;   ///< only some of their pixels were looked at, or only some of their foci played
  std::uint64_t left_out_frames = 0;  ///< of which no drive reached the array
  std::uint64_t skin_frames = 0;      ///< all frames with skin over the object, of which the frames above are some
  bool operator==(const TouchLosses&) const = default;
};

/// What was played in a touch, beside what the plan says. Empty where nothing was played.
struct Stimulus {
  std::string model_sha256{};
  double ceiling = 0;           ///< of the amplitudes
  std::string foci_file{};      ///< name of the file with the foci of the touch
  std::string drives_sha256{};  ///< of all drives that were sent in the touch
  std::uint64_t drives = 0;     ///< their number
  std::string layout{};         ///< of the array that played
  std::optional<TouchLosses> losses{};
  bool operator==(const Stimulus&) const = default;
};

/// One line. Fields that do not belong to its kind are empty and not written.
struct Entry {
  EntryKind kind = EntryKind::start;
  std::int64_t at_ns = 0;               ///< on a clock that only goes forward, from the last start
  std::optional<double> sounded_s{};    ///< how long the array has sounded since the entry before, if it has
  std::optional<std::uint32_t> step{};  ///< index into the participant's order
  bool by_machine = false;              ///< of void: no person broke it off, so it is repeated only most_repeats times
  std::string text{};                   ///< answer, chosen shape, reason; of a start: its UTC time
  std::string version{};                ///< of a start: palpa's
  bool rehearsal = false;               ///< of a start: nobody was there
  std::string masking{};                ///< of a start: the sound in the headphones, if there is an array
  std::string backend{};                ///< of a start: what computed, "gpu" or "cpu"
  bool accepted = false;                ///< of consent
  bool depth_frames = false;            ///< of consent: depth images may be kept
  std::optional<double> deep_s{};       ///< of touched: how long nothing was played, because a point was too deep
  std::optional<Stimulus> stimulus{};   ///< of touched
  std::optional<double> level_db{};     ///< of level: peak at the louder ear
  std::optional<double> dose_db{};      ///< of level: equivalent for the plan's minutes
  bool operator==(const Entry&) const = default;
};

/// How long the array sounded altogether, seconds.
double sounded_s(std::span<const Entry> entries);

std::string head_line(const JournalHead& head);
/// `before`: the digits of the line before.
std::string entry_line(const Entry& entry, std::string_view before);
/// The digits of a line that head_line() or entry_line() made.
std::string_view digits_of(std::string_view line);

struct Journal {
  std::optional<JournalHead> head{};  ///< missing if the text ends before its first LF
  std::vector<Entry> entries{};
  std::string last_digits{};  ///< of the last whole line
  std::size_t whole = 0;      ///< bytes up to the end of the last whole line; the rest was cut off
};

/// Throws bad_input naming the line for a line that was changed, that is no entry, or of another version. `name` is for
/// messages.
Journal read_journal(std::string_view text, const std::string& name);

}  // namespace palpa::study
