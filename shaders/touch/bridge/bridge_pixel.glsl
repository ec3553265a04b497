// The pixel at which a camera sees a skin point, and the skin's normal there. The includer needs the buffers depth, rays
// and cameras, and push.cameras.
#include "shaders/sensing/raw_depth.glsl"

struct SeenPixel {
  uint camera, u, v;
};

SeenPixel pixel_of(uint point) {
  uint c = 0u;
  for (uint i = 1u; i < push.cameras; ++i) c = point >= cameras[i].first_index ? i : c;
  const uint v = (point - cameras[c].first_index) / cameras[c].width;
  return SeenPixel(c, point - cameras[c].first_index - v * cameras[c].width, v);
}

Float3 point_of(BridgeCamera camera, uint u, uint v) {
  const vec2 ray = rays[camera.first_pixel + v * camera.pitch + u];
  return pixel_point(camera, raw_at(camera, u, v), Float2(ray.x, ray.y));
}

Float3 normal_at(uint point) {
  const SeenPixel p = pixel_of(point);
  const BridgeCamera camera = cameras[p.camera];
  const uint u = p.u, v = p.v;
  const Float3 nothing = Float3(0.0, 0.0, 0.0);
  const uint far = bridge_normal_pixels;
  const Float3 at = point_of(camera, u, v);
  Float3 left = nothing, right = nothing, above = nothing, below = nothing;
  if (u >= far) left = point_of(camera, u - far, v);
  if (u + far < camera.width) right = point_of(camera, u + far, v);
  if (v >= far) above = point_of(camera, u, v - far);
  if (v + far < camera.height) below = point_of(camera, u, v + far);
  return skin_normal(camera, at, left, right, above, below);
}
