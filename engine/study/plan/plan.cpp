#include "study/plan/plan.hpp"

#include <algorithm>
#include <iterator>

namespace palpa::study {

bool asks(BlockKind kind) {
  return kind == BlockKind::practice || kind == BlockKind::trial;
}

const std::vector<DefaultText>& default_texts() {
  static const std::vector<DefaultText> texts{
      {"consent", TextId::consent,
       "In this study you touch shapes that are made of ultrasound. You can stop at any time, without giving a reason. "
       "Your answers are kept under a number, without your name. Do you take part?"},
      {"depth_consent", TextId::depth_consent,
       "May the depth images of your hand be kept, too? You can take part without this."},
      {"accept", TextId::accept, "yes"},
      {"decline", TextId::decline, "no"},
      {"go_on", TextId::go_on, "Press the space bar when you are ready."},
      {"wait", TextId::wait, "One moment, please."},
      {"welcome", TextId::welcome, "Please put on the headphones. The study begins as soon as you are ready."},
      {"familiarise", TextId::familiarise,
       "You see a shape with a marker on top of it. Move your finger up and down from the marker, and feel the shape."},
      {"free", TextId::free,
       "Now you see only the marker. Feel the shapes. The arrow keys change the shape as often as you like."},
      {"practice", TextId::practice,
       "Move your finger up and down from the marker. Afterwards, say which shape it was. This one does not count."},
      {"trial", TextId::trial, "Move your finger up and down from the marker. Afterwards, say which shape it was."},
      {"rest", TextId::rest, "Have a rest."},
      {"felt", TextId::felt, "Did you feel anything?", true},
      {"not_yet", TextId::not_yet, "Please wait for the question.", true},
      {"which_shape", TextId::which_shape, "Which shape was it?"},
      {"paused", TextId::paused, "Paused. Please take your hand away and wait."},
      {"right", TextId::right_answer, "Right."},
      {"wrong", TextId::wrong_answer, "Wrong."},
      {"end", TextId::end, "That was all. Thank you."},
  };
  return texts;
}

std::string StudyPlan::text(TextId id) const {
  if (const auto own = texts.find(language); own != texts.end()) {
    if (const auto found = own->second.find(id); found != own->second.end()) return found->second;
  }
  if (language != "en" && id == TextId::felt) return "";
  if (language != "en" && id == TextId::not_yet) return text(TextId::wait);
  if (id == TextId::welcome && run.masking == "off") return "The study begins as soon as you are ready.";
  return std::ranges::find(default_texts(), id, &DefaultText::id)->english;
}

const std::string& StudyPlan::label(std::size_t shape) const {
  const auto found = shapes[shape].labels.find(language);
  return found == shapes[shape].labels.end() ? shapes[shape].name : found->second;
}

std::string instruction_of(const StudyPlan& plan, const PlanBlock& block) {
  if (!block.text.empty()) return block.text;
  switch (block.kind) {
    case BlockKind::familiarise:
      return plan.text(TextId::familiarise);
    case BlockKind::free:
      return plan.text(TextId::free);
    case BlockKind::practice:
      return plan.text(TextId::practice);
    case BlockKind::trial:
      return plan.text(TextId::trial);
    case BlockKind::rest:
      return plan.text(TextId::rest);
  }
  return {};
}

std::uint32_t trials_of_method(const StudyPlan& plan) {
  std::size_t trials = 0;
  for (const PlanBlock& block : plan.blocks) {
    if (block.kind == BlockKind::trial && !block.once) trials += block.shapes.size() * block.repeats;
  }
  return static_cast<std::uint32_t>(trials);
}

std::uint32_t default_least_trials(const StudyPlan& plan) {
  return (3 * trials_of_method(plan) + 3) / 4;
}

std::vector<std::string> doubts_of(const StudyPlan& plan) {
  std::vector<std::string> doubts;
  if (std::ranges::find(plan.blocks, BlockKind::trial, &PlanBlock::kind) == plan.blocks.end()) {
    doubts.emplace_back("has no [[block]] of the kind 'trial', and nothing else is analysed");
  } else if (trials_of_method(plan) == 0 && plan.methods.size() > 1) {
    doubts.emplace_back("each block 'trial' has once = true: there are trials with a participant's first method only");
  }
  if (plan.level.ceiling == 0) doubts.emplace_back("the ceiling of [level] is 0: nothing sounds");
  return doubts;
}

double sounding_s(const StudyPlan& plan) {
  double seconds = 0;
  for (const PlanBlock& block : plan.blocks) {
    double touches = static_cast<double>(block.shapes.size()) * block.repeats;
    if (block.kind == BlockKind::free) touches = 1;
    if (block.kind == BlockKind::rest) touches = 0;
    seconds += touches * block.touch_s * (block.once ? 1.0 : static_cast<double>(plan.methods.size()));
  }
  return seconds;
}

}  // namespace palpa::study
