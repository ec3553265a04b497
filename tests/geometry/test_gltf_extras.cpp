// The haptics that a modeller writes into a node's custom properties.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf_builder.hpp"
#include "support/captured.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::box;
using test::GltfBuilder;
using Json = GltfBuilder::Json;

GltfBuilder cube_with(const Json& extras) {
  GltfBuilder builder(box(Vec3(0), Vec3(1)));
  builder.doc["nodes"][0]["extras"] = extras;
  return builder;
}
Haptics haptics_of(const Json& extras) {
  Haptics haptics;
  EXPECT_EQ(test::stderr_of([&] { haptics = load(cube_with(extras)).meshes.at(0).haptics; }), "") << extras;
  return haptics;
}
std::string extras_fault_of(const Json& extras) {
  return fault_of(cube_with(extras));
}
std::string extras_warnings_of(const Json& extras) {
  return warnings_of(cube_with(extras));
}

const Json all{{"touchable", false},
               {"delta_m", 0.002},
               {"foci", 9},
               {"stride", 4},
               {"dwell_s", 0.0025},
               {"intensity", 0.5},
               {"pressure_pa", 8000},
               {"press_depth_m", 0.003},
               {"click", Json::array({0.03, 150})},
               {"stiffness", Json::array({0, 0.25, 0.002, 1, 0.004, 0.5})},
               {"texture", Json::array({1, 0, 0.5})},
               {"grain_m", 0.003}};
const Haptics all_values{false,
                         0.002,
                         0.0025,
                         0.5,
                         8000,
                         0.003,
                         9,
                         4,
                         Click{0.03, 150},
                         std::vector<DepthForce>{{0, 0.25}, {0.002, 1}, {0.004, 0.5}},
                         std::array<double, 3>{1, 0, 0.5},
                         0.003};

TEST(Extras, AreReadFromAGroupAndFlat) {
  EXPECT_EQ(haptics_of({{"palpa", all}}), all_values);
  Json flat = {{"someone_else", "'s"}, {"delta_m", "theirs"}};
  for (const auto& [key, value] : all.items())
    flat["palpa_" + key] = value;
  EXPECT_EQ(haptics_of(flat), all_values);
}

TEST(Extras, BothFormsTogetherButNoKeyTwice) {
  const Haptics h = haptics_of({{"palpa", {{"foci", 8}}}, {"palpa_delta_m", 0.001}});
  EXPECT_EQ(h.foci, 8U);
  EXPECT_EQ(h.delta_m, 0.001);
  EXPECT_CONTAINS(extras_fault_of({{"palpa", {{"foci", 8}}}, {"palpa_foci", 8}}),
                  "node 0: extras: \"palpa_foci\" is also given in \"palpa\"");
}

TEST(Extras, NothingIsTheDefault) {
  for (const Json& extras : {Json::object(), Json{{"palpa", Json::object()}}, Json("text"), Json::array({1, 2}), Json(),
                             Json{{"palpable", 1}}, Json{{"delta_m", -1}}})
    EXPECT_EQ(haptics_of(extras), Haptics{});
}

TEST(Extras, WhatModellingProgramsMakeOfNumbers) {
  // Blender: no booleans in old versions, floats in place of integers, single precision.
  EXPECT_FALSE(haptics_of({{"palpa_touchable", 0}}).touchable);
  EXPECT_TRUE(haptics_of({{"palpa_touchable", 1}}).touchable);
  EXPECT_EQ(haptics_of({{"palpa_foci", 10.0}}).foci, 10U);
  EXPECT_EQ(haptics_of({{"palpa_intensity", 1}}).intensity, 1.0);
  EXPECT_EQ(haptics_of({{"palpa_delta_m", 0.001500000013038516}}).delta_m, 0.001500000013038516);
  EXPECT_TRUE(haptics_of({{"palpa_click", Json::array({0.029999999329447746, 200.0})}, {"palpa_press_depth_m", 0.01}})
                  .clicks());
}

TEST(Extras, WrongTypesAndRangesAreNamed) {
  const auto list = [](const std::vector<double>& numbers) { return Json(numbers); };
  struct Case {
    const char* key;
    Json value;
    std::string fault;
  };
  const std::string click =
      "it must be true, false, or the burst's length and frequency: [0.03 to 0.06 seconds, 150 to "
      "200 Hz]";
  const std::string table = "it must be a list of 1 to 32 pairs, a depth in metres and the force there";
  const std::string weights = "it must be the weights of [steady, 30 Hz, 150 Hz], each from 0 to 1 and not all 0";
  const std::vector<Case> cases{
      {"touchable", "no", "is \"no\"; it must be true or false"},
      {"touchable", 2, "is 2; it must be true or false"},
      {"touchable", nullptr, "is null; it must be true or false"},
      {"delta_m", 0, "is 0; it must be a number above 0 and at most 0.1 metres"},
      {"delta_m", 1.5, "is 1.5; it must be a number above 0 and at most 0.1 metres"},
      {"delta_m", "1.5mm", "is \"1.5mm\"; it must be a number"},
      {"delta_m", true, "is true"},
      {"delta_m", Json::array({0.001}), "is [0.001]"},
      {"foci", 0, "a whole number from 1 to 64"},
      {"foci", 65, "is 65; it must be a whole number from 1 to 64"},
      {"foci", 2.5, "is 2.5"},
      {"foci", -3, "is -3"},
      {"foci", "10", "whole number"},
      {"stride", 0, "a whole number from 1 to 1048576"},
      {"stride", 1e300, "a whole number"},
      {"dwell_s", 0, "a number of at least 1e-06 and at most 10 seconds"},
      {"dwell_s", 11, "at most 10 seconds"},
      {"intensity", 1.01, "a number of at least 0 and at most 1"},
      {"intensity", -0.1, "at least 0"},
      {"pressure_pa", 0, "a number above 0 and at most 100000 pascals"},
      {"pressure_pa", 100001, "at most 100000 pascals"},
      {"press_depth_m", 0, "a number above 0 and at most 1 metres"},
      {"press_depth_m", Json::object(), "is {}"},
      {"click", 2, "is 2; " + click},
      {"click", "yes", "is \"yes\"; " + click},
      {"click", nullptr, click},
      {"click", Json::object(), click},
      {"click", list({}), click},
      {"click", list({0.045}), click},
      {"click", list({0.02, 200}), "is [0.02,200.0]; " + click},
      {"click", list({0.07, 200}), click},
      {"click", list({0.045, 149}), click},
      {"click", list({0.045, 201}), click},
      {"click", list({0.045, 1e300}), click},
      {"click", Json::array({0.045, "200"}), click},
      {"stiffness", 0.5, table},
      {"stiffness", list({}), table},
      {"stiffness", list({0, 0.1, 0.004}), table},
      {"stiffness", list(std::vector<double>(66, 0.1)), table},
      {"stiffness", Json::array({Json::array({0, 1}), Json::array({0.1, 1})}), table},
      {"stiffness", list({0.004, 0.1, 0.002, 1}), "has the depth 0.002 after 0.004; depths must ascend"},
      {"stiffness", list({0.004, 0.1, 0.004, 1}), "has the depth 0.004 after 0.004; depths must ascend"},
      {"stiffness", list({-0.001, 0.1}), "has the depth -0.001; depths must be from 0 to 1 metres"},
      {"stiffness", list({4, 0.1}), "has the depth 4; depths must be from 0 to 1 metres"},
      {"stiffness", list({0, -0.1}), "has the force -0.1; forces must be from 0 to 1"},
      {"stiffness", list({0, 1.1}), "has the force 1.1; forces must be from 0 to 1"},
      {"texture", 1, weights},
      {"texture", list({1, 1}), weights},
      {"texture", list({1, 1, 1, 1}), weights},
      {"texture", list({0, 0, 0}), "is [0.0,0.0,0.0]; " + weights},
      {"texture", list({1, -0.1, 0}), weights},
      {"texture", list({1, 0, 1.1}), weights},
      {"texture", Json::array({1, nullptr, 0}), weights},
      {"grain_m", 0, "is 0; it must be a number of at least 0.0001 and at most 0.1 metres"},
      {"grain_m", 2, "at most 0.1 metres"},
  };
  for (const Case& c : cases) {
    // A click needs a press depth.
    Json flat{{std::string("palpa_") + c.key, c.value}}, group{{c.key, c.value}};
    flat.emplace("palpa_press_depth_m", 0.003);
    group.emplace("press_depth_m", 0.003);
    EXPECT_CONTAINS(extras_fault_of({{"palpa", group}}), c.fault);
    const std::string line = extras_fault_of(flat);
    EXPECT_CONTAINS(line, std::string("node 0: extras: \"palpa_") + c.key + "\" ");
    EXPECT_CONTAINS(line, c.fault);
  }
  EXPECT_CONTAINS(extras_fault_of({{"palpa", 3}}), "\"palpa\" is not a JSON object");
  EXPECT_CONTAINS(extras_fault_of({{"palpa", Json::array()}}), "\"palpa\" is not a JSON object");
}

TEST(Extras, AClickNeedsAPressDepthAndMayBeTurnedOff) {
  for (const Json& on : {Json(true), Json(1), Json(1.0)}) {
    EXPECT_EQ(haptics_of({{"palpa_click", on}, {"palpa_press_depth_m", 0.003}}).click, Click());
    EXPECT_CONTAINS(extras_fault_of({{"palpa_click", on}}),
                    "node 0: extras: a click plays when a finger presses, so \"palpa_press_depth_m\" must say");
  }
  for (const Json& off : {Json(false), Json(0)})
    EXPECT_FALSE(haptics_of({{"palpa_click", off}}).clicks());
  // A child of a button that has neither a depth of its own nor a click.
  GltfBuilder builder;
  builder.add_mesh(box(Vec3(0), Vec3(1)));
  const int quiet = builder.add_node({{"mesh", 0}, {"extras", {{"palpa_click", false}}}}, false);
  const int heir = builder.add_node({{"mesh", 0}}, false);
  builder.add_node({{"children", {quiet, heir}}, {"extras", {{"palpa_click", true}, {"palpa_press_depth_m", 0.002}}}});
  const Scene scene = load(builder);
  EXPECT_FALSE(scene.meshes.at(0).haptics.clicks());
  EXPECT_TRUE(scene.meshes.at(1).haptics.clicks());
}

TEST(Extras, FociAndStrideMustVisitAll) {
  EXPECT_CONTAINS(extras_fault_of({{"palpa", {{"foci", 10}, {"stride", 4}}}}),
                  "stride 4 and 10 foci share the divisor 2");
  EXPECT_EQ(haptics_of({{"palpa", {{"foci", 1}, {"stride", 4}}}}).stride, 4U);
  EXPECT_EQ(haptics_of({{"palpa", {{"stride", 4}}}}).stride, 4U);
}

TEST(Extras, AMisspeltKeyIsAWarningWithAGuess) {
  EXPECT_CONTAINS(extras_warnings_of({{"palpa", {{"delta", 0.001}}}}),
                  "palpa does not know \"delta\"; did you mean \"delta_m\"?");
  EXPECT_CONTAINS(extras_warnings_of({{"palpa_touchabel", false}}),
                  "palpa does not know \"palpa_touchabel\"; did you mean \"palpa_touchable\"?");
  EXPECT_CONTAINS(extras_warnings_of({{"palpa", {{"Foci", 8}}}}), "did you mean \"foci\"?");
  EXPECT_CONTAINS(extras_warnings_of({{"palpa", {{"palpa_foci", 8}}}}), "did you mean \"foci\"?");
  EXPECT_CONTAINS(extras_warnings_of({{"palpa", {{"colour", "red"}}}}), "known are touchable, delta_m");
  for (const char* key : {"palpa-foci", "palpaFoci", "Palpa_foci", "palpa.foci", "palpafoci", "palpa foci",
                          "PALPA_FOCI", "palpa:foci", "Palpa Foci", " palpa_foci", "\tpalpa_foci", "_palpa_foci",
                          "palpa_foci ", "\u00A0palpa_foci", "\uFEFFpalpa_foci", " Palpa foci"}) {
    EXPECT_CONTAINS(extras_warnings_of({{key, 8}}), "did you mean \"palpa_foci\"?") << key;
  }
  EXPECT_CONTAINS(extras_warnings_of({{"palpa-press-depth-m", 0.003}}), "did you mean \"palpa_press_depth_m\"?");
  EXPECT_CONTAINS(extras_warnings_of({{"palpaPressDepth", 0.003}}), "did you mean \"palpa_press_depth_m\"?");
  EXPECT_CONTAINS(extras_warnings_of({{"Palpa-colour", "red"}}), "known are touchable, delta_m");
  EXPECT_CONTAINS(extras_warnings_of({{"palpa", {{"pressDepthM", 1}}}}), "did you mean \"press_depth_m\"?");
  for (const char* group : {" palpa", "Palpa", "palpa:"})
    EXPECT_CONTAINS(extras_warnings_of({{group, {{"foci", 8}}}}), "did you mean \"palpa\"?") << group;
  EXPECT_EQ(extras_warnings_of({{"palpable", true}, {"palpation", 3}, {"my_palpa_foci", 8}, {" ", 1}, {"", 2}}), "");
  // A file full of them prints only a few lines.
  Json many;
  for (int i = 0; i < 1000; ++i)
    many["key" + std::to_string(i)] = i;
  const std::string warnings = extras_warnings_of({{"palpa", many}});
  EXPECT_LE(std::count(warnings.begin(), warnings.end(), '\n'), 8);
}

TEST(Extras, ExtrasOfAMeshAreAWarning) {
  GltfBuilder builder = cube_with(Json::object());
  builder.doc["meshes"][0]["extras"] = {{"palpa_delta_m", 0.001}};
  EXPECT_CONTAINS(warnings_of(builder), "mesh 0: palpa reads only the extras of nodes");
  EXPECT_EQ(load(builder).meshes.at(0).haptics, Haptics{});
  builder.doc["meshes"][0]["extras"] = {{"targetNames", {"a"}}};
  EXPECT_EQ(warnings_of(builder), "");
}

TEST(Extras, ExtrasElsewhereAreAWarningWithTheirPlace) {
  const Json extras = {{"palpa_texture", {0.2, 1, 0.6}}};
  const std::string belong = ": palpa reads only the extras of nodes";
  const std::pair<std::string, std::function<void(Json&)>> table[]{
      {"material 0",
       [&](Json& doc) {
         doc["materials"] = {{{"name", "rough"}, {"extras", extras}}};
       }},
      {"scene 0", [&](Json& doc) { doc["scenes"][0]["extras"] = extras; }},
      {"the file",
       [&](Json& doc) {
         doc["extras"] = {{"palpa", {{"foci", 8}}}};
       }},
      {"mesh 0, primitive 0", [&](Json& doc) { doc["meshes"][0]["primitives"][0]["extras"] = extras; }},
      {"camera 1",
       [&](Json& doc) {
         doc["cameras"] = {Json::object(), {{"extras", {{"palpaFoci", 8}}}}};
       }},
      {"asset", [&](Json& doc) { doc["asset"]["extras"] = extras; }},
      {"accessor 0", [&](Json& doc) { doc["accessors"][0]["extras"] = extras; }},
      {"bufferView 0", [&](Json& doc) { doc["bufferViews"][0]["extras"] = extras; }},
      {"extensions, KHR_lights_punctual, light 1",
       [&](Json& doc) {
         doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}},
                                                               {{"type", "point"}, {"extras", {{" palpa_foci", 8}}}}};
       }},
      {"node 0, extensions, KHR_lights_punctual",
       [&](Json& doc) {
         doc["nodes"][0]["extensions"]["KHR_lights_punctual"] = {{"light", 0}, {"extras", extras}};
       }},
      {"animation 0, channel 0",
       [&](Json& doc) {
         doc["animations"] = {{{"channels", {{{"extras", extras}}}}, {"samplers", Json::array()}}};
       }},
      {"mesh 0, primitive 0, target 0",
       [&](Json& doc) {
         doc["meshes"][0]["primitives"][0]["targets"] = {{{"extras", extras}}};
       }},
  };
  for (const auto& [place, change] : table) {
    GltfBuilder builder = cube_with(Json::object());
    change(builder.doc);
    EXPECT_CONTAINS(warnings_of(builder), place + belong);
  }
  for (const std::string list : {"animation", "skin", "texture", "sampler", "image", "material"}) {
    GltfBuilder builder = cube_with(Json::object());
    builder.doc[list + "s"] = {{{"extras", extras}}};
    EXPECT_CONTAINS(warnings_of(builder), list + " 0" + belong);
  }
  GltfBuilder packed = cube_with(Json::object());
  packed.doc["buffers"] = {{{"byteLength", packed.bin.size()}, {"extras", extras}}};
  EXPECT_CONTAINS(warnings_of(packed), "buffer 0" + belong);
  Json own = {{"palpa_foci", 8}, {"other", {{"extras", extras}}}};
  own["list"] = {{{"extras", extras}}};
  EXPECT_EQ(extras_warnings_of(own), "") << "what other programs keep in the node's extras";
}

TEST(Extras, ChildrenInheritValueByValue) {
  GltfBuilder builder;
  builder.add_mesh(box(Vec3(0), Vec3(1)));
  const int leaf = builder.add_node({{"mesh", 0}, {"extras", {{"palpa", {{"foci", 8}}}}}}, false);
  const int own = builder.add_node({{"mesh", 0}, {"extras", {{"palpa_touchable", true}}}}, false);
  const int middle = builder.add_node({{"children", {leaf, own}}, {"extras", {{"palpa_delta_m", 0.002}}}}, false);
  builder.add_node(
      {{"children", {middle}}, {"extras", {{"palpa", {{"touchable", false}, {"delta_m", 0.01}, {"foci", 4}}}}}});
  builder.add_node({{"mesh", 0}});
  const Scene scene = load(builder);
  Haptics expected;
  expected.touchable = false;
  expected.delta_m = 0.002;
  expected.foci = 8;
  EXPECT_EQ(scene.meshes.at(0).haptics, expected);
  expected.touchable = true;
  expected.foci = 4;
  EXPECT_EQ(scene.meshes.at(1).haptics, expected);
  EXPECT_EQ(scene.meshes.at(2).haptics, Haptics{});
  // Inherited values must also fit.
  builder.doc["nodes"][0]["extras"] = {{"palpa_stride", 2}};
  EXPECT_CONTAINS(fault_of(builder), "node 0: extras: stride 2 and 4 foci");
}

}  // namespace
}  // namespace palpa::geometry
