#include <gtest/gtest.h>

#include "shaders/viewer/view_scene.h"
#include "spirv/view_disc.frag.hpp"
#include "spirv/view_disc.vert.hpp"
#include "spirv/view_edge.vert.hpp"
#include "spirv/view_mesh.frag.hpp"
#include "spirv/view_mesh.vert.hpp"
#include "spirv/view_stroke.vert.hpp"
#include "support/spirv.hpp"

namespace palpa {
namespace {

TEST(ViewLayout, ItemsAndPushConstantsAreWhatTheShadersHave) {
  const auto mesh = test::read_spirv(spirv::view_mesh_vert);
  ASSERT_EQ(mesh.bindings.size(), 1u);
  EXPECT_EQ(mesh.bindings[0].number, shader::view_items);
  EXPECT_EQ(mesh.array_strides.at("ViewVertex"), sizeof(shader::ViewVertex));
  EXPECT_EQ(mesh.structs.at("ViewVertex").offsets.at("normal"), offsetof(shader::ViewVertex, normal));
  const auto stroke = test::read_spirv(spirv::view_stroke_vert);
  EXPECT_EQ(stroke.array_strides.at("ViewStroke"), sizeof(shader::ViewStroke));
  EXPECT_EQ(stroke.structs.at("ViewStroke").offsets.at("to"), offsetof(shader::ViewStroke, to));
  EXPECT_EQ(stroke.structs.at("ViewStroke").offsets.at("colour"), offsetof(shader::ViewStroke, colour));
  const auto edge = test::read_spirv(spirv::view_edge_vert);
  EXPECT_EQ(edge.array_strides.at("ViewEdge"), sizeof(shader::ViewEdge));
  EXPECT_EQ(edge.structs.at("ViewEdge").offsets.at("to"), offsetof(shader::ViewEdge, to));
  const auto disc = test::read_spirv(spirv::view_disc_vert);
  EXPECT_EQ(disc.array_strides.at("ViewDisc"), sizeof(shader::ViewDisc));
  EXPECT_EQ(disc.structs.at("ViewDisc").offsets.at("colour"), offsetof(shader::ViewDisc, colour));
  for (const auto& module :
       {mesh, stroke, edge, disc, test::read_spirv(spirv::view_mesh_frag), test::read_spirv(spirv::view_disc_frag)}) {
    const auto& push = module.structs.at("ViewPush").offsets;
    EXPECT_EQ(push.at("clip_w"), offsetof(shader::ViewPush, clip_w));
    EXPECT_EQ(push.at("eye"), offsetof(shader::ViewPush, eye));
    EXPECT_EQ(push.at("window"), offsetof(shader::ViewPush, window));
    EXPECT_EQ(push.at("colour"), offsetof(shader::ViewPush, colour));
    EXPECT_EQ(push.at("style"), offsetof(shader::ViewPush, style));
  }
}

}  // namespace
}  // namespace palpa
