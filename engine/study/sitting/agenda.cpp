#include "study/sitting/agenda.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"

namespace palpa::study {

Agenda::Agenda(std::vector<Step> steps)
    : steps_(std::move(steps)), left_(steps_.size()), by_machine_(steps_.size(), 0) {
  std::iota(left_.begin(), left_.end(), 0u);
}

std::optional<std::uint32_t> Agenda::current() const {
  if (left_.empty() || finished_ || (consent_ && !consent_->accepted)) return std::nullopt;
  return left_.front();
}

void Agenda::put_back() {
  const std::uint32_t step = left_.front();
  left_.pop_front();
  const auto after =
      std::ranges::find_if(left_, [&](std::uint32_t other) { return steps_[other].round != steps_[step].round; });
  left_.insert(after, step);
  open_ = false;
  ++voided_;
}

std::string Agenda::take(const Entry& entry) {
  if (finished_ && entry.kind != EntryKind::start && entry.kind != EntryKind::stop)
    return "it follows the end of the sitting";
  const bool needs_open = entry.kind == EntryKind::touched || entry.kind == EntryKind::choose ||
                          entry.kind == EntryKind::answer || entry.kind == EntryKind::done ||
                          entry.kind == EntryKind::broken;
  const bool current_step = !left_.empty() && entry.step && *entry.step == left_.front();
  if (needs_open && (!open_ || !current_step)) return "its step is not under way";
  if (starts_ == 0 && entry.kind != EntryKind::start) return "the sitting has not been started";
  switch (entry.kind) {
    case EntryKind::start:
      if (open_) put_back();
      ++starts_;
      break;
    case EntryKind::consent:
      consent_ = Consent{entry.accepted, entry.depth_frames};
      break;
    case EntryKind::begin:
      if (!consent_ || !consent_->accepted) return "a step begins without consent";
      if (open_ || !current_step) return "another step is next";
      open_ = true;
      break;
    case EntryKind::answer:
    case EntryKind::done:
      left_.pop_front();
      open_ = false;
      ++complete_;
      break;
    case EntryKind::broken:
      if (entry.by_machine && last_repeat()) {
        stay_void_.push_back(left_.front());
        left_.pop_front();
        open_ = false;
        ++voided_;
        break;
      }
      by_machine_[left_.front()] += entry.by_machine ? 1 : 0;
      put_back();
      break;
    case EntryKind::finish:
      if (open_ || (!left_.empty() && (!consent_ || consent_->accepted))) return "steps are left";
      finished_ = true;
      break;
    case EntryKind::level:
    case EntryKind::touched:
    case EntryKind::choose:
    case EntryKind::pause:
    case EntryKind::resume:
    case EntryKind::stop:
      break;
  }
  return {};
}

Agenda agenda_after(std::vector<Step> steps, std::span<const Entry> entries, const std::string& name) {
  Agenda agenda(std::move(steps));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (const std::string fault = agenda.take(entries[i]); !fault.empty())
      throw bad_input(name, fmt::format("line {}: '{}' cannot stand here: {}", i + 2,
                                        word_of(entry_words, entries[i].kind), fault));
  }
  return agenda;
}

std::string to_json(const Agenda& agenda, std::uint32_t participant) {
  JsonWriter json;
  json.begin_object()
      .member("participant", participant)
      .member("complete", agenda.complete())
      .member("void", agenda.voided())
      .member("stay_void", agenda.stay_void().size())
      .member("starts", agenda.starts())
      .member("ended", agenda.finished())
      .end_object();
  return json.take();
}

}  // namespace palpa::study
