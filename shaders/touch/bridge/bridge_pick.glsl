// Picks some contacts of a finger by a hash of their numbers, with the skin's normal there from the depth picture. A
// group of 64 does this. The includer needs the buffers parents, contacts, depth, rays and cameras, and push.cameras.
shared uint least[bridge_samples];
shared uint count_taken;
shared Float3 positions[bridge_samples];
shared Float3 normals[bridge_samples];

#include "shaders/touch/bridge/bridge_pixel.glsl"

const uint sum_threads = bridge_samples, sum_row = 8u;
#include "shaders/shared/sum_before.glsl"

// Fills positions and normals of `count_taken` samples, in the order of the hash. Only contacts with a normal are
// samples. least[] has the hash of each contact, with or without a normal.
void pick_samples(uint root, uint count) {
  const uint thread = gl_LocalInvocationIndex;
  least[thread] = 0xffffffffu;
  barrier();
  for (uint i = thread; i < count; i += bridge_group) {
    if (parents[i] != root) continue;
    const uint hash = i * bridge_hash;
    atomicMin(least[hash >> bridge_sample_shift], hash);
  }
  barrier();
  bool taken = least[thread] != 0xffffffffu;
  Float3 position = Float3(0.0, 0.0, 0.0);
  Float3 normal = position;
  if (taken) {
    const uint i = least[thread] * bridge_unhash;
    position = Float3(contacts[i].x, contacts[i].y, contacts[i].z);
    normal = normal_at(contacts[i].point);
    taken = dot3(normal, normal) > 0.0;
  }
  // Closes up the samples, in the order of the hash.
  const uint place = sum_before(taken ? 1u : 0u);
  if (taken) {
    positions[place] = position;
    normals[place] = normal;
  }
  if (thread == bridge_samples - 1u) count_taken = place + (taken ? 1u : 0u);
  barrier();
}
