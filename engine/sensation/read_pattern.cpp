#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "geometry/gltf_document/json.hpp"
#include "sensation/pattern.hpp"

namespace palpa::sensation {
namespace {

using geometry::gltf::Item;
using geometry::gltf::Json;

constexpr const char* format_name = "MidAirHapticsAnimationFileFormat";
constexpr const char* revisions[] = {"0.1.0-alpha.3", "0.1.0-alpha.2", "0.0.10-alpha.1"};
constexpr std::size_t most_nodes = 100'000;
/// In one formula. In each step of 0.05 ms, about 25 numbers are computed.
constexpr std::size_t most_nodes_of_one = 256;
constexpr double infinite = std::numeric_limits<double>::infinity();

constexpr Word<Keyframe::Kind> keyframe_words[] = {
    {"standard", Keyframe::Kind::standard}, {"pause", Keyframe::Kind::pause}, {"stop", Keyframe::Kind::stop}};
constexpr Word<Transition> transition_words[] = {{"linear", Transition::linear}, {"step", Transition::step}};
constexpr Word<Brush::Kind> brush_words[] = {
    {"circle", Brush::Kind::circle}, {"line", Brush::Kind::line}, {"lissajous", Brush::Kind::lissajous}};
constexpr Word<bool> intensity_words[] = {{"constant", false}, {"random", true}};
constexpr Word<Jump::Operator> operator_words[] = {{"lt", Jump::Operator::lt},
                                                   {"lt_eq", Jump::Operator::lt_eq},
                                                   {"gt", Jump::Operator::gt},
                                                   {"gt_eq", Jump::Operator::gt_eq}};
constexpr Word<Number::Kind> node_words[] = {
    {"constant", Number::Kind::constant}, {"parameter", Number::Kind::parameter}, {"add", Number::Kind::add},
    {"subtract", Number::Kind::subtract}, {"multiply", Number::Kind::multiply},   {"divide", Number::Kind::divide},
    {"negate", Number::Kind::negate}};

/// Reads one document, and remembers the keys that it does not know.
class Reader {
 public:
  explicit Reader(Pattern& pattern) : pattern_(pattern) {}

  void read(const Item& root);
  void warn() const {
    if (unknown_.empty()) return;
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(unknown_.size(), 3); ++i)
      text += (i > 0 ? ", " : "") + unknown_[i];
    if (unknown_.size() > 3) text += fmt::format(" and {} more", unknown_.size() - 3);
    log::warning(fmt::format("{}: ignores keys that the format does not know: {}", pattern_.file, text));
  }

 private:
  void know(const Item& item, std::initializer_list<const char*> keys) {
    for (const auto& member : item.json().items()) {
      if (std::ranges::none_of(keys, [&](const char* key) { return member.key() == key; }))
        unknown_.push_back(fmt::format("\"{}\" of {}", printable(member.key(), 40), item.where()));
    }
  }
  template <typename Enum, std::size_t count>
  Enum word(const Item& item, const char* key, const Word<Enum> (&words)[count]) {
    const std::optional<Enum> value = value_of(words, item.string(key).value_or(""));
    if (!value) item.fail(fmt::format("\"{}\" must be {}", key, one_of(words)));
    return *value;
  }
  static const Json& needed(const Item& item, const char* key) {
    const auto found = item.json().find(key);
    if (found == item.json().end()) item.fail(fmt::format("\"{}\" is missing", key));
    return *found;
  }
  static double finite(const Item& item, const Json& value, const char* key) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      item.fail(fmt::format("\"{}\" is not a finite number", key));
    return value.get<double>();
  }
  static double plain(const Item& item, const char* key) { return finite(item, needed(item, key), key); }

  std::uint32_t parameter(const std::string& name);
  std::uint32_t node(const Item& item, Number& number);
  Number number(const Item& item, const char* key);
  Transition transition(const Item& item);
  void params(const Item& item) { know(item.needed_item("params"), {}); }
  Brush brush(const Item& item);
  Intensity intensity(const Item& item);
  Jump jump(const Item& item);
  Keyframe keyframe(const Item& item);
  void definition(const std::string& name, const Item& item);
  void transform(const Item& item);

  Pattern& pattern_;
  std::map<std::string, std::uint32_t> numbers_;  ///< of the parameters
  std::size_t nodes_ = 0;                         ///< of all formulas
  std::vector<std::string> unknown_;
};

std::uint32_t Reader::parameter(const std::string& name) {
  const auto [found, is_new] = numbers_.try_emplace(name, static_cast<std::uint32_t>(pattern_.parameters.size()));
  if (is_new) pattern_.parameters.push_back({name, false, 0, -infinite, infinite});
  return found->second;
}

/// Adds a formula's tree, operands first.
std::uint32_t Reader::node(const Item& item, Number& number) {
  know(item, {"type", "value"});
  if (++nodes_ > most_nodes) item.fail(fmt::format("formulas have more than {} parts", most_nodes));
  Number::Node made{word(item, "type", node_words)};
  if (made.kind == Number::Kind::constant) {
    made.value = plain(item, "value");
  } else if (made.kind == Number::Kind::parameter) {
    const auto name = item.string("value");
    if (!name) item.fail("\"value\" is missing");
    made.a = parameter(*name);
  } else if (made.kind == Number::Kind::negate) {
    made.a = node(item.needed_item("value"), number);
  } else {
    if (item.array("value") == nullptr || item.size("value") != 2) item.fail("\"value\" must be an array of two");
    made.a = node(item.element("value", item.where() + ", operand", 0), number);
    made.b = node(item.element("value", item.where() + ", operand", 1), number);
  }
  number.nodes.push_back(made);
  if (number.nodes.size() > most_nodes_of_one)
    item.fail(fmt::format("a formula has more than {} parts", most_nodes_of_one));
  return static_cast<std::uint32_t>(number.nodes.size() - 1);
}

Number Reader::number(const Item& item, const char* key) {
  const Item given(item.file(), needed(item, key), fmt::format("\"{}\" of {}", key, item.where()));
  know(given, {"type", "value"});
  const std::string type = given.string("type").value_or("");
  if (type == "f64") return Number::of(plain(given, "value"));
  if (type == "param" || type == "dynamic") {
    const auto name = given.string("value");
    if (!name) given.fail("\"value\" is missing");
    return {{{Number::Kind::parameter, 0, parameter(*name), 0}}};
  }
  if (type != "formula") given.fail("\"type\" must be f64, param or formula");
  Number made;
  node(given.needed_item("value"), made);
  return made;
}

Transition Reader::transition(const Item& item) {
  const Item given = item.needed_item("transition");
  know(given, {"name", "params"});
  params(given);
  return word(given, "name", transition_words);
}

Brush Reader::brush(const Item& item) {
  know(item, {"name", "params"});
  const Item p = item.needed_item("params");
  Brush made{.kind = word(item, "name", brush_words)};
  made.am_hz = number(p, "am_freq");
  made.stm_hz = p.has("stm_freq") ? number(p, "stm_freq") : Number::of(100);
  switch (made.kind) {
    case Brush::Kind::circle:
      know(p, {"radius", "am_freq", "stm_freq"});
      made.size = number(p, "radius");
      break;
    case Brush::Kind::line:
      know(p, {"length", "thickness", "rotation", "am_freq", "stm_freq"});
      made.size = number(p, "length");
      number(p, "thickness");  // needed, without an effect
      made.rotation = number(p, "rotation");
      break;
    case Brush::Kind::lissajous:
      know(p, {"a", "b", "d", "rotation", "x_scale", "y_scale", "am_freq", "stm_freq"});
      made.a = number(p, "a");
      made.b = number(p, "b");
      made.d = number(p, "d");
      made.rotation = number(p, "rotation");
      made.x_scale = number(p, "x_scale");
      made.y_scale = number(p, "y_scale");
      break;
  }
  return made;
}

Intensity Reader::intensity(const Item& item) {
  know(item, {"name", "params"});
  const Item p = item.needed_item("params");
  Intensity made{.random = word(item, "name", intensity_words)};
  if (made.random) {
    know(p, {"min", "max"});
    made.low = number(p, "min");
    made.high = number(p, "max");
  } else {
    know(p, {"value"});
    made.low = number(p, "value");
  }
  return made;
}

Jump Reader::jump(const Item& item) {
  know(item, {"condition", "jump_to"});
  const Item condition = item.needed_item("condition");
  know(condition, {"parameter", "operator", "value"});
  const auto name = condition.string("parameter");
  if (!name) condition.fail("\"parameter\" is missing");
  const Item is = condition.needed_item("operator");
  know(is, {"name", "params"});
  params(is);
  return {parameter(*name), word(is, "name", operator_words), plain(condition, "value"), plain(item, "jump_to")};
}

/// Whether an optional member is there: null is as good as none.
bool there(const Item& item, const char* key) {
  const auto found = item.json().find(key);
  return found != item.json().end() && !found->is_null();
}

Keyframe Reader::keyframe(const Item& item) {
  Keyframe made{.kind = word(item, "type", keyframe_words), .time_ms = plain(item, "time")};
  if (made.kind == Keyframe::Kind::stop) return made;
  if (made.kind == Keyframe::Kind::standard) {
    know(item, {"type", "time", "coords", "brush", "intensity", "cjumps"});
    const Item coords = item.needed_item("coords");
    know(coords, {"coords", "transition"});
    const Item at = coords.needed_item("coords");
    know(at, {"x", "y", "z"});
    made.coords = {{plain(at, "x"), plain(at, "y"), plain(at, "z")}, transition(coords)};
  } else {
    know(item, {"type", "time", "coords", "brush", "intensity", "cjumps"});
  }
  if (there(item, "brush")) {
    const Item given = item.needed_item("brush");
    know(given, {"brush", "transition"});
    made.brush = {brush(given.needed_item("brush")), transition(given)};
  }
  if (there(item, "intensity")) {
    const Item given = item.needed_item("intensity");
    know(given, {"intensity", "transition"});
    made.intensity = {intensity(given.needed_item("intensity")), transition(given)};
  }
  if (item.array("cjumps") == nullptr) item.fail("\"cjumps\" is missing");
  for (std::size_t j = 0; j < item.size("cjumps"); ++j)
    made.jumps.push_back(jump(item.element("cjumps", item.where() + ", jump", j)));
  return made;
}

void Reader::definition(const std::string& name, const Item& item) {
  know(item, {"default", "step", "min", "max"});
  plain(item, "step");
  Parameter& made = pattern_.parameters[parameter(name)];
  made.defined = true;
  made.usual = plain(item, "default");
  if (there(item, "min")) made.low = plain(item, "min");
  if (there(item, "max")) made.high = plain(item, "max");
  if (made.low > made.high) item.fail(fmt::format("\"min\" is {:g}, above \"max\", {:g}", made.low, made.high));
}

void Reader::transform(const Item& item) {
  know(item, {"geometric_transforms", "intensity_factor", "playback_speed"});
  const Item geometric = item.needed_item("geometric_transforms");
  know(geometric, {"translate", "rotation", "scale"});
  for (auto* part : {&pattern_.translate, &pattern_.scale}) {
    const Item given = geometric.needed_item(part == &pattern_.translate ? "translate" : "scale");
    know(given, {"x", "y", "z"});
    *part = {number(given, "x"), number(given, "y"), number(given, "z")};
  }
  pattern_.rotation = number(geometric, "rotation");
  pattern_.intensity_factor = number(item, "intensity_factor");
  pattern_.playback_speed = number(item, "playback_speed");
}

void Reader::read(const Item& root) {
  if (root.string("$DATA_FORMAT").value_or("") != format_name)
    root.fail(fmt::format("\"$DATA_FORMAT\" is not {}: this is no pattern of Adaptics", format_name));
  const std::string revision = root.string("$REVISION").value_or("");
  if (std::ranges::none_of(revisions, [&](const char* known) { return revision == known; }))
    root.fail(fmt::format("\"$REVISION\" is '{}'; palpa reads {}", printable(revision, 40), known_revisions));
  know(root, {"$DATA_FORMAT", "$REVISION", "name", "keyframes", "pattern_transform", "user_parameter_definitions"});
  const auto name = root.string("name");
  if (!name) root.fail("\"name\" is missing");
  pattern_.name = *name;
  const Item definitions = root.needed_item("user_parameter_definitions");
  for (const auto& member : definitions.json().items())
    definition(member.key(),
               Item(root.file(), member.value(), fmt::format("parameter \"{}\"", printable(member.key(), 40))));
  if (root.array("keyframes") == nullptr) root.fail("\"keyframes\" is missing");
  for (std::size_t k = 0; k < root.size("keyframes"); ++k)
    pattern_.keyframes.push_back(keyframe(root.element("keyframes", "keyframe", k)));
  std::ranges::stable_sort(pattern_.keyframes, {}, &Keyframe::time_ms);
  transform(root.needed_item("pattern_transform"));
}

/// What a search finds that has passed the keyframe, in either direction.
void pass(const Pattern& pattern, std::size_t index, FoundTracks& found) {
  const Keyframe& keyframe = pattern.keyframes[index];
  const auto see = [&](bool sets, Found& track, bool retimes) {
    if (sets) {
      track = {static_cast<std::int64_t>(index), keyframe.time_ms};
    } else if (track.keyframe >= 0 && retimes) {
      track.time_ms = keyframe.time_ms;
    }
  };
  const bool stop = keyframe.kind == Keyframe::Kind::stop;
  see(keyframe.coords.has_value(), found.coords, keyframe.kind != Keyframe::Kind::standard);
  see(keyframe.brush.has_value(), found.brush, stop);
  see(keyframe.intensity.has_value(), found.intensity, stop);
}

}  // namespace

Pattern parse_pattern(const std::string& text, const std::string& file) {
  Pattern pattern{.file = file};
  const geometry::gltf::Parsed parsed(file, text);
  Reader reader(pattern);
  reader.read(Item(file, parsed.json(), "the pattern"));
  const std::size_t count = pattern.keyframes.size();
  pattern.before.resize(count + 1);
  pattern.after.resize(count + 1);
  for (std::size_t k = 0; k < count; ++k) {
    pattern.before[k + 1] = pattern.before[k];
    pass(pattern, k, pattern.before[k + 1]);
  }
  for (std::size_t k = count; k-- > 0;) {
    pattern.after[k] = pattern.after[k + 1];
    pass(pattern, k, pattern.after[k]);
  }
  reader.warn();
  return pattern;
}

Pattern load_pattern(const std::string& file) {
  return parse_pattern(read_text_file(file, most_pattern_bytes), file);
}

}  // namespace palpa::sensation
