// The live run of a sitting has each method's own values, and each value of the plan and of the command line. Its link
// fits the plan's layouts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sitting_bench.hpp"
#include "support/files.hpp"
#include "support/thrown.hpp"
#include "viewer/study/presentation.hpp"

namespace palpa::viewer {
namespace {

struct Asked {
  study::StudyPlan plan;
  setup::StudyRunOptions run;
};

/// Two methods of which everything differs.
Asked asked() {
  Asked a;
  a.plan.methods.resize(2);
  study::PlanMethod &one = a.plan.methods[0], &other = a.plan.methods[1];
  one.name = "one";
  one.method = touch::Method::single_focus;
  one.layout = "openmpd";
  one.modulation_hz = 150;
  other.name = "other";
  other.method = touch::Method::cross_section;
  other.layout = "autd3";
  other.foci = 7;
  other.stride = 2;
  other.dwell_s = 2e-3;
  other.delta_m = 2e-3;
  a.plan.level.ceiling = 0.3;
  a.run.link = "null";
  a.run.source = "synthetic";
  return a;
}

std::string text_of(const setup::LiveOptions& o) {
  return fmt::format("{} {} {} {} {} {} | {} {} {} {} {} {} | {} {} {} {} | {} {} {} {}", o.scene, o.source, o.rig.rig,
                     o.rig.layout, o.link, o.board_files, o.touch.parameters.delta_m, o.touch.parameters.foci,
                     o.touch.stride.value_or(0), o.touch.dwell_s, o.touch.modulation_hz,
                     static_cast<int>(o.touch.method.method), static_cast<int>(o.axes), static_cast<int>(o.smoothing),
                     o.hysteresis ? static_cast<int>(*o.hysteresis) : -1, o.predict ? static_cast<int>(*o.predict) : -1,
                     o.safety.ceiling, o.hold_s, o.hold_auto, static_cast<int>(o.common.backend));
}

TEST(OptionsOfAMethod, HaveItsDrives) {
  Asked a = asked();
  const auto drive_of = [&](std::size_t method) {
    return options_of_method(a.plan, method, a.run, "shapes.glb").drive;
  };
  study::PlanMethod& one = a.plan.methods[0];
  one.amplitude = array::Weighting::distance;
  one.solver = array::Solver::naive;
  one.constraint = array::Constraint::clamp;
  EXPECT_EQ(drive_of(0).weighting, array::Weighting::distance);
  EXPECT_EQ(drive_of(0).solver, setup::SolverChoice::naive);
  EXPECT_EQ(drive_of(0).constraint, array::Constraint::clamp);
  EXPECT_FALSE(drive_of(1).weighting || drive_of(1).solver || drive_of(1).constraint) << "as a run does";
}

TEST(OptionsOfAMethod, AreItsOwnWhateverItsPlace) {
  Asked a = asked();
  const std::string one = text_of(options_of_method(a.plan, 0, a.run, "shapes.glb"));
  const std::string other = text_of(options_of_method(a.plan, 1, a.run, "shapes.glb"));
  EXPECT_NE(one, other);
  std::swap(a.plan.methods[0], a.plan.methods[1]);
  EXPECT_EQ(text_of(options_of_method(a.plan, 0, a.run, "shapes.glb")), other);
  EXPECT_EQ(text_of(options_of_method(a.plan, 1, a.run, "shapes.glb")), one);
}

TEST(OptionsOfAMethod, HaveEachValueOfPlanAndLine) {
  const std::pair<const char*, std::function<void(Asked&)>> changes[]{
      {"method", [](Asked& a) { a.plan.methods[1].method = touch::Method::ellipse; }},
      {"layout", [](Asked& a) { a.plan.methods[1].layout = "openmpd"; }},
      {"foci", [](Asked& a) { a.plan.methods[1].foci = 8; }},
      {"stride", [](Asked& a) { a.plan.methods[1].stride = 3; }},
      {"dwell", [](Asked& a) { a.plan.methods[1].dwell_s = 3e-3; }},
      {"delta", [](Asked& a) { a.plan.methods[1].delta_m = 1e-3; }},
      {"modulation", [](Asked& a) { a.plan.methods[1].modulation_hz = 190; }},
      {"axes", [](Asked& a) { a.plan.run.axes = touch::Axes::covariance; }},
      {"smoothing", [](Asked& a) { a.plan.run.smoothing = touch::Smoothing::none; }},
      {"hysteresis", [](Asked& a) { a.plan.run.hysteresis = touch::Hysteresis::off; }},
      {"predict", [](Asked& a) { a.plan.run.predict = false; }},
      {"ceiling", [](Asked& a) { a.plan.level.ceiling = 0.4; }},
      {"source", [](Asked& a) { a.run.source = "recording:take"; }},
      {"link", [](Asked& a) { a.run.link = "openmpd:A"; }},
      {"board files", [](Asked& a) { a.run.board_files = "boards"; }},
      {"hold", [](Asked& a) { a.run.hold_s = 0.05; }},
      {"hold auto", [](Asked& a) { a.run.hold_auto = !a.run.hold_auto; }},
      {"backend", [](Asked& a) { a.run.common.backend = setup::Backend::cpu; }}};
  const Asked plain = asked();
  const std::string before = text_of(options_of_method(plain.plan, 1, plain.run, "shapes.glb"));
  const std::string of_other = text_of(options_of_method(plain.plan, 0, plain.run, "shapes.glb"));
  for (const auto& [what, change] : changes) {
    Asked a = asked();
    change(a);
    EXPECT_NE(text_of(options_of_method(a.plan, 1, a.run, "shapes.glb")), before) << what;
  }
  EXPECT_NE(text_of(options_of_method(plain.plan, 1, plain.run, "other.glb")), before);
  Asked method = asked();
  method.plan.methods[1] = method.plan.methods[0];
  EXPECT_EQ(text_of(options_of_method(method.plan, 1, method.run, "shapes.glb")), of_other);
}

/// A plan that leaves the array open fits any; one that names it says what is wrong in the plan's own words.
TEST(StudyLinks, LayoutsAreThoseOfTheArray) {
  const std::filesystem::path folder = test::scratch_folder("study-layouts");
  test::SittingBench bench(folder, test::write_study_plan(folder, ""));
  setup::StudyRunOptions run = bench.options();
  run.link = "null";
  check_study_links(bench.plan(), run, {});
  EXPECT_NO_THROW(try_study_link(bench.plan(), run, {}));
  run.rig = test::source_file("assets/rigs/paper.toml");
  EXPECT_ERROR(check_study_links(bench.plan(), run, {}), Exit::usage, "its array is paper, but method single-focus");
  run = {};
  run.link = "own:X";
  LiveSession::Kinds kinds;
  session::LinkKind own = test::heard_link(std::make_shared<test::HeardSound>());
  own.name = "own";
  own.own_layout = [](const std::string&) { return std::string("openmpd"); };
  kinds.links.push_back(own);
  study::StudyPlan plan = bench.plan();
  EXPECT_ERROR(take_layouts(plan, run, kinds), Exit::usage,
               "method single-focus has layout = \"autd3\", but the boards of --link own:X are the array openmpd");
  for (study::PlanMethod& method : plan.methods)
    method.layout_given = false;
  take_layouts(plan, run, kinds);
  EXPECT_EQ(plan.methods[1].layout, "openmpd");
  for (const auto& [fault, told] :
       {std::pair("no such boards: give --layout x",
                  "in a study, --layout is `layout` of the [[method]] 'single-focus' in"),
        {"too fast: use --dwell 12ms, or --method single-focus",
         "in a study, --dwell is `dwell_ms` and --method is `method` of the [[method]] 'single-focus' in"}}) {
    kinds.links[0].open = [text = std::string(fault)](const std::string&,
                                                      const session::LinkSetting&) -> std::unique_ptr<session::Link> {
      throw bad_usage(text);
    };
    EXPECT_ERROR(try_study_link(plan, run, kinds), Exit::usage, told);
  }
  std::vector<bool> told_to_move, moves;
  kinds.links[0].open = [&, open = own.open](const std::string& argument, const session::LinkSetting& setting) {
    told_to_move.push_back(setting.foci_move);
    return open(argument, setting);
  };
  for (std::size_t m = 0; m < plan.methods.size(); ++m) {
    plan.methods[m].dwell_s = 1e-3 * static_cast<double>(1 + m);
    moves.push_back(!touch::stands_still(plan.methods[m].method));
  }
  try_study_link(plan, run, kinds);
  EXPECT_EQ(told_to_move, moves);
  run.rig = test::source_file("assets/rigs/paper.toml");
  EXPECT_EQ((take_layouts(plan, run, kinds), plan.methods[1].layout), "paper") << "the rig's";
}

}  // namespace
}  // namespace palpa::viewer
