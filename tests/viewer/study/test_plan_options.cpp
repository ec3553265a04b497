// The live run of a sitting has each method's own values, and each value of the plan and of the command line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

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

}  // namespace
}  // namespace palpa::viewer
