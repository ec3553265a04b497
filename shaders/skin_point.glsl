// Common to the two skin shaders. `precise` keeps a compiler from fusing, so that both shaders and the C++ twin agree on every
// bit wherever additions and products round correctly.

uint raw_depth(uvec4 words, uint i) { return words[i >> 1] >> ((i & 1u) * 16u) & 0xffffu; }

vec3 skin_point(uint raw, vec2 ray) {
  precise const float z = float(raw) * push.box_low.w;
  precise const float x = ray.x * z;
  precise const float y = ray.y * z;
  precise vec3 world;
  world.x = ((push.pose_x.x * x + push.pose_x.y * y) + push.pose_x.z * z) + push.pose_x.w;
  world.y = ((push.pose_y.x * x + push.pose_y.y * y) + push.pose_y.z * z) + push.pose_y.w;
  world.z = ((push.pose_z.x * x + push.pose_z.y * y) + push.pose_z.z * z) + push.pose_z.w;
  return world;
}

bool inside(vec3 point) {
  return all(greaterThanEqual(point, push.box_low.xyz)) && all(lessThanEqual(point, push.box_high.xyz));
}
