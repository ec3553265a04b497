#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/acoustics/field.h"
#include "shaders/shared/turns.glsl"

// The complex pressure at points of the free field: each thread sums all transducers for its own points.
layout(local_size_x = 32) in;
layout(constant_id = 0) const uint directional = 1u;  // 0: the transducers sound equally in all directions
layout(constant_id = 1) const uint absorbing = 1u;    // 0: the air absorbs nothing

layout(set = 0, binding = 0) uniform samplerBuffer sources;
layout(std430, set = 0, binding = 1) readonly buffer Points { FieldPoint points[]; };
layout(set = 0, binding = 2) uniform usamplerBuffer directivity;
layout(std430, set = 0, binding = 3) writeonly buffer Pressures { FieldPressure pressures[]; };
layout(push_constant) uniform Push { FieldPush push; };

float directivity_at(float cosine) {
  const float steps = float(field_directivity_steps);
  const float at = clamp((cosine + 1.0) * (0.5 * steps), 0.0, steps);
  const float step = min(floor(at), steps - 1.0);
  const vec2 entry = uintBitsToFloat(texelFetch(directivity, int(step)).xy);
  return entry.x + entry.y * (at - step);
}

void main() {
  const uint begin = gl_WorkGroupID.x * (field_group * field_each) + gl_LocalInvocationIndex;
  vec3 coarse[field_each], fine[field_each];
  vec2 sum[field_each];
  for (uint k = 0u; k < field_each; ++k) {
    const FieldPoint point = points[min(begin + k * field_group, push.points - 1u)];
    coarse[k] = point.coarse.xyz;
    fine[k] = point.fine.xyz;
    sum[k] = vec2(0.0);
  }
  for (uint n = 0u; n < push.sources; ++n) {
    const vec4 source_coarse = texelFetch(sources, int(3u * n));
    const vec4 source_fine = texelFetch(sources, int(3u * n + 1u));
    const vec3 axis = directional != 0u ? texelFetch(sources, int(3u * n + 2u)).xyz : vec3(0.0);
    const vec2 strength = vec2(source_coarse.w, source_fine.w);
    for (uint k = 0u; k < field_each; ++k) {
      precise const vec3 way = (coarse[k] - source_coarse.xyz) + (fine[k] - source_fine.xyz);
      precise const float distance = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
      float loud = 1.0 / max(distance, push.nearest);
      if (directional != 0u) {
        const float cosine = (way.x * axis.x + way.y * axis.y + way.z * axis.z) / max(distance, 1e-9);
        loud *= directivity_at(distance > 0.0 ? cosine : 1.0);
      }
      if (absorbing != 0u) loud *= exp2(-push.halvings * distance);
      sum[k] += loud * times(strength, unit_of_turns(distance));
    }
  }
  for (uint k = 0u; k < field_each; ++k) {
    const uint i = begin + k * field_group;
    if (i < push.points) pressures[i] = FieldPressure(sum[k].x, sum[k].y);
  }
}
