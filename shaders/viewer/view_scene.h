// Shared by viewer/ and shaders/viewer/view_*: the data that the viewer's pipelines fetch, and their common push
// constants.
#ifndef PALPA_SHADERS_VIEW_SCENE_H
#define PALPA_SHADERS_VIEW_SCENE_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// Every pipeline fetches one array, at binding 0. Images have their pixels at binding 1: 4 bytes each, red the lowest.
PALPA_CONST view_items = 0u;
PALPA_CONST view_buffers = 1u;
PALPA_CONST view_pixels = 1u;
PALPA_CONST view_image_buffers = 2u;

// Samples per pixel in pictures that are drawn with several.
PALPA_CONST view_samples = 4u;

// A corner of a triangle. Three consecutive corners form a triangle; in a mesh, three consecutive indices do.
struct ViewVertex {
  vec4 position;  // xyz metres; w: its own colour if it has one, (256 red + green) 256 + blue; of an image: x in it
  vec4 normal;    // xyz unit; w: 1 if it has its own colour, else 0; of an image: y in it, 0 to 1 from the top
};
PALPA_CHECK_SIZE(ViewVertex, 32);
PALPA_CHECK_OFFSET(ViewVertex, normal, 16);

// A line with round ends, constant width on the screen. A stroke from a point to itself is a disc.
struct ViewStroke {
  vec4 from;    // xyz metres in the world, or x y in pixels from the top left; w: half the width in pixels
  vec4 to;      // xyz likewise; w unused
  vec4 colour;  // rgb as on the screen, alpha
};
PALPA_CHECK_SIZE(ViewStroke, 48);
PALPA_CHECK_OFFSET(ViewStroke, colour, 32);

// An edge of a mesh that is drawn as a line.
struct ViewEdge {
  vec4 from;  // xyz metres; w unused
  vec4 to;
};
PALPA_CHECK_SIZE(ViewEdge, 32);
PALPA_CHECK_OFFSET(ViewEdge, to, 16);

// A point or a transducer.
struct ViewDisc {
  vec4 centre;  // xyz metres; w: radius in metres
  vec4 axis;    // xyz: unit normal, or 0: faces the viewer and is shaded like a ball; w: least radius in pixels
  vec4 colour;  // rgb; w: greatest radius in pixels
};
PALPA_CHECK_SIZE(ViewDisc, 48);
PALPA_CHECK_OFFSET(ViewDisc, colour, 32);

struct ViewPush {
  vec4 clip_x;  // rows of the map from the world to clip coordinates, y down, depth 1 near and 0 far
  vec4 clip_y;
  vec4 clip_z;
  vec4 clip_w;
  vec4 eye;  // w = 1: the eye's position; w = 0: the direction towards a viewer infinitely far away
  vec4
      window;  // x, y: size in pixels; z: pixels per metre where clip w = 1; w: depth bias towards the viewer, relative
  vec4 colour;  // mesh, edge: rgb and alpha; stroke, disc: unused
  // mesh: x alpha at the silhouette, y 1 for shading, 0 for none, z 1 if no corner has its own colour;
  // image: x its first pixel, y and z its width and height in pixels, w opacity; edge: x half the width in pixels;
  // stroke: x 1 if coordinates are pixels, y multiplies widths; edge, stroke: z and w where the view begins, pixels;
  // disc: x outline in pixels, y multiplies radii given in pixels, z opacity, w: the step between the discs that are
  // drawn, counted from the first in the buffer
  vec4 style;
};
PALPA_CHECK_SIZE(ViewPush, 128);
PALPA_CHECK_OFFSET(ViewPush, eye, 64);
PALPA_CHECK_OFFSET(ViewPush, colour, 96);

PALPA_SHADER_END

#ifndef __cplusplus
layout(push_constant) uniform Push {
  ViewPush push;
};

vec4 to_clip(vec3 world) {
  const vec4 p = vec4(world, 1.0);
  return vec4(dot(push.clip_x, p), dot(push.clip_y, p), dot(push.clip_z, p), dot(push.clip_w, p));
}

// From a point of the world to the viewer.
vec3 towards_viewer(vec3 world) {
  return normalize(push.eye.xyz - push.eye.w * world);
}

// In pixels. Never nothing, not even of a disc that is all zeros, which is what a software device's idle lanes have:
// they would divide by it, and what they then say of clipping holds for all.
float disc_radius(ViewDisc disc, float clip_w) {
  const float own = disc.centre.w * push.window.z / clip_w;
  return max(clamp(own, disc.axis.w * push.style.y, disc.colour.w * push.style.y), 0.1);
}

// A triangle all of whose corners are here has no area and is not drawn. It lies where nothing needs to be clipped: one
// corner beyond the picture sends hundreds of triangles around it through a software device's clipper.
const vec4 nowhere = vec4(0.0, 0.0, 0.0, 1.0);
#endif

#endif
