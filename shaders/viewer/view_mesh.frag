#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"

// Translucent surfaces: soft light from above and from the viewer, denser where the surface turns away, like glass.
layout(location = 0) in vec3 world;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 paint;
layout(location = 0) out vec4 colour;

void main() {
  const vec3 viewer = towards_viewer(world);
  const vec3 n = normal / max(length(normal), 1e-6);
  const float facing = abs(dot(n, viewer));
  const float sky = 0.5 + 0.5 * n.y;
  const float light = mix(1.0, 0.62 + 0.26 * facing + 0.16 * sky, push.style.y);
  const float rim = (1.0 - facing) * (1.0 - facing);
  colour = vec4(min(paint * light, vec3(1.0)), mix(push.colour.a, push.style.x, rim));
}
