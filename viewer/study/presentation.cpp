#include "viewer/study/presentation.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "sensing/rig.hpp"
#include "session/links/link.hpp"
#include "session/links/safe_link.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/sessions/load.hpp"
#include "study/sitting/ear_level.hpp"

namespace palpa::viewer {
namespace {

/// Poses that are set while a frame is planned hold from the next frame on, and another one may already be under way.
constexpr std::uint64_t frames_until_placed = 3;
/// Without a newer look at the skin, nobody knows how deep the finger is.
constexpr std::chrono::milliseconds longest_unseen{500};

/// For the options of palpa run that an error names and a study does not have, the keys of the plan: "--dwell is
/// `dwell_ms`". Empty if there are none.
std::string keys_of_options(std::string_view error) {
  std::string keys;
  for (const auto& [option, key] : {std::pair("--layout", "layout"),
                                    {"--dwell", "dwell_ms"},
                                    {"--method", "method"},
                                    {"--foci", "foci"},
                                    {"--modulation-frequency", "modulation_hz"}}) {
    if (error.find(option) != std::string_view::npos)
      keys += fmt::format("{}{} is `{}`", keys.empty() ? "" : " and ", option, key);
  }
  return keys;
}

}  // namespace

setup::LiveOptions options_of_method(const study::StudyPlan& plan, std::size_t method,
                                     const setup::StudyRunOptions& run, const std::string& scene) {
  const study::PlanMethod& own = plan.methods[method];
  setup::LiveOptions options;
  options.common = run.common;
  options.common.json.clear();
  options.scene = scene;
  options.source = run.source;
  options.rig.rig = run.rig;
  const bool placed_by_rig = !run.rig.empty() && sensing::load_rig(run.rig).array.has_value();
  if (!placed_by_rig) options.rig.layout = own.layout;
  options.link = run.link;
  options.board_files = run.board_files;
  options.touch.parameters.delta_m = own.delta_m;
  options.touch.delta_given = true;
  options.touch.parameters.foci = own.foci;
  options.touch.stride = own.stride;
  options.touch.dwell_s = own.dwell_s;
  options.touch.dwell_given = true;
  options.touch.modulation_hz = own.modulation_hz;
  options.touch.method.method = own.method;
  options.touch.method_given = true;
  options.drive.weighting = own.amplitude;
  if (own.solver) options.drive.solver = setup::choice_of(*own.solver);
  options.drive.constraint = own.constraint;
  options.axes = plan.run.axes;
  options.smoothing = plan.run.smoothing;
  options.hysteresis = plan.run.hysteresis;
  options.predict = plan.run.predict ? session::Predict::automatic : session::Predict::off;
  options.safety.ceiling = plan.level.ceiling;
  options.ceiling_known = true;
  options.hold_s = run.hold_s;
  options.hold_auto = run.hold_auto;
  return options;
}

void take_layouts(study::StudyPlan& plan, const setup::StudyRunOptions& run, const LiveSession::Kinds& kinds) {
  const sensing::Rig rig = run.rig.empty() ? sensing::Rig() : sensing::load_rig(run.rig);
  const std::string own = session::layout_of_link(run.link, setup::with_builtin(kinds.links));
  for (study::PlanMethod& method : plan.methods) {
    const bool built_in = std::filesystem::path(method.layout).extension() != ".toml";
    if (!method.layout_given) {
      if (rig.array) {
        method.layout = rig.array->layout;
      } else if (!own.empty()) {
        method.layout = own;
      }
    } else if (!rig.array && !own.empty() && built_in && method.layout != own) {
      throw bad_usage(fmt::format(
          "{}: method {} has layout = \"{}\", but the boards of --link {} are the array {}: write this into "
          "its [[method]], or leave layout out",
          plan.file, method.name, method.layout, run.link, own));
    }
  }
}

void try_study_link(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const LiveSession::Kinds& kinds) {
  const std::vector<session::LinkKind> links = setup::with_builtin(kinds.links);
  std::set<std::tuple<std::string, double, double, bool>> tried;
  for (std::size_t m = 0; m < plan.methods.size(); ++m) {
    const setup::LiveOptions options = options_of_method(plan, m, run, "");
    const study::PlanMethod& method = plan.methods[m];
    const bool foci_move = !touch::stands_still(method.method);
    if (!tried.emplace(method.layout, method.dwell_s, foci_move ? 0 : method.modulation_hz, foci_move).second) continue;
    const setup::PlacedLayout placed = setup::load_placed_layout(options.rig);
    const array::Layout layout = array::transformed(placed.layout, placed.T_world_layout);
    try {
      if (!foci_move && setup::plays_slot_by_slot(run.link, links))
        setup::refuse_coarse_modulation(method.dwell_s, method.modulation_hz);
      const auto link = session::open_link(run.link, links,
                                           {.layout = layout,
                                            .solid_names = {},
                                            .slot_s = options.touch.dwell_s,
                                            .foci_move = foci_move,
                                            .steps = false,
                                            .board_files = run.board_files});
      session::SafeLink(*link, layout.transducers.size()).finish();
      if (const array::Layout* const boards = link->boards()) study::refuse_silent(plan, boards);
    } catch (const Error& error) {
      const std::string keys = keys_of_options(error.what());
      if (keys.empty()) throw;
      throw Error(error.code(), fmt::format("{}; in a study, {} of the [[method]] '{}' in {}", error.what(), keys,
                                            plan.methods[m].name, plan.file));
    }
  }
}

void try_study_source(const study::StudyPlan& plan, const setup::StudyRunOptions& run,
                      const LiveSession::Kinds& kinds) {
  setup::try_source(options_of_method(plan, 0, run, ""), kinds.sources);
}

void check_study_links(const study::StudyPlan& plan, const setup::StudyRunOptions& run,
                       const LiveSession::Kinds& kinds) {
  const std::vector<session::LinkKind> links = setup::with_builtin(kinds.links);
  if (!session::file_of_link(run.link, links).empty()) {
    throw bad_usage(
        fmt::format("--link {}: a study does not play into a file, because every method would begin it again; the foci "
                    "of each touch "
                    "are written anyway",
                    run.link));
  }
  if (run.rig.empty()) return;
  const sensing::Rig rig = sensing::load_rig(run.rig);
  if (!rig.array) return;
  for (const study::PlanMethod& method : plan.methods) {
    if (method.layout == rig.array->layout) continue;
    throw bad_usage(
        fmt::format("{}: its array is {}, but method {} of {} needs {}: give a rig with this array, or one "
                    "without an array",
                    run.rig, rig.array->layout, method.name, plan.file, method.layout));
  }
}

Presentation::Presentation(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const StudyShapes& shapes,
                           std::filesystem::path scene, const LiveSession::Kinds& kinds, std::atomic<bool>& stop,
                           std::function<void()> wake, const session::Clock& clock)
    : plan_(&plan),
      run_(&run),
      shapes_(&shapes),
      scene_file_(std::move(scene)),
      kinds_{kinds.sources, behind_gate(setup::with_builtin(kinds.links), gate_)},
      stop_(&stop),
      wake_(std::move(wake)),
      gate_(clock) {}

Presentation::~Presentation() {
  gate_.close();
}

void Presentation::prepare(std::size_t method, std::size_t shape) {
  const bool other = method_ != method || shape_ != shape || !fault_.empty() || !wanted_;
  if (!other) return;
  gate_.close();
  method_ = method;
  shape_ = shape;
  wanted_ = true;
  if (!fault_.empty()) session_method_.reset();  // another session opens the array again
  fault_.clear();
  if (session_ && !session_->over() && session_method_ != method_) session_->all_off();
  look();
}

/// The run of a failed session has set the flag.
void Presentation::start() {
  if (setup::Interrupt::signalled()) return;
  session_.reset();
  *stop_ = false;
  if (setup::Interrupt::signalled()) *stop_ = true;
  session_method_ = method_;
  gate_.restart();
  placed_.reset();
  forget_seen();
  newest_ = 0;
  session_ = std::make_unique<LiveSession>(options_of_method(*plan_, *method_, *run_, scene_file_.string()), kinds_,
                                           *stop_, wake_, Patience{}, gate_.frames());
}

void Presentation::place() {
  const auto scene = session_->scene();
  if (!scene || placed_ == shape_) return;
  session_->place(only(*shape_, scene->solid_names));
  placed_ = shape_;
  may_be_old_ = true;
  forget_seen();
}

void Presentation::forget_seen() {
  since_.reset();
  since_s_.reset();
  lowest_.reset();
  seen_at_.reset();
}

void Presentation::look() {
  if (!wanted_) return;
  if (session_ && session_->over()) {
    const bool asked = session_method_ != method_;
    if (!asked || !session_->fault().empty()) {
      gate_.close();
      const char* without = session_->unattended() ? "the program stood still" : "the source of frames has ended";
      fault_ = session_->fault().empty() ? without : session_->fault();
    }
    session_.reset();
  }
  if (session_) session_->look();
  if (!fault_.empty()) return;
  if (!session_) start();
  if (!session_ || session_method_ != method_) return;
  if (gate_.unheard() > Gate::longest_unheard) {
    gate_.doubt();
    gate_.close();
    // The session stays: its link silences the array as soon as that takes drives again.
    fault_ = "the array takes no drives: see whether it is plugged in and switched on";
    return;
  }
  place();
  if (session_->take()) {
    newest_ = session_->snapshot().sequence;
    rate_hz_ = session_->snapshot().numbers.rate_hz;
    // The first snapshot after the shape was placed may be one that has waited here since long before.
    if (placed_ && !since_ && !std::exchange(may_be_old_, false)) since_ = newest_ + frames_until_placed;
    if (since_ && newest_ >= *since_ && !since_s_) since_s_ = session_->snapshot().time_s;
  }
  if (session_->take_seen() && since_ && session_->seen().sequence >= *since_) {
    lowest_ = lowest_point(session_->seen().skin.points, shapes_->shapes[*shape_].box);
    seen_at_ = gate_.now();
    const std::optional<double> depth = deepest_m();
    gate_.frames().seen(session_->seen().sequence, depth.has_value(), depth && !(*depth <= plan_->run.deep_m));
  }
}

bool Presentation::ready() const {
  return session_ && fault_.empty() && session_method_ == method_ && placed_ == shape_ && since_ && since_s_ &&
         gate_.newest_s() >= *since_s_ && seen_at_ && gate_.now() - *seen_at_ < longest_unseen;
}

void Presentation::open(Clock::time_point until) {
  if (ready()) {
    gate_.open(until);
  } else {
    gate_.close();
  }
}

std::optional<double> Presentation::deepest_m() const {
  if (!lowest_ || !shape_) return std::nullopt;
  return shapes_->shapes[*shape_].box.high.y - lowest_->y;
}

double Presentation::slot_s() const {
  return method_ ? plan_->methods[*method_].dwell_s : 1.5e-3;
}

void Presentation::record(const std::string& folder) {
  if (session_) session_->record(folder);
}

bool Presentation::end(std::chrono::milliseconds patience) {
  gate_.close();
  wanted_ = false;
  if (!session_) return true;
  session_->all_off();
  const Clock::time_point until = Clock::now() + patience;
  while (!session_->over() && Clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  if (!session_->over()) return false;
  end_fault_ = session_->fault();
  session_.reset();
  return true;
}

}  // namespace palpa::viewer
