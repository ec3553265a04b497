#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/contacts/contacts_chunk.glsl"
#include "shaders/shared/scan.h"

// Brings the contacts of all chunks together, in input order.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Points { uvec4 points[]; };
layout(std430, set = 0, binding = 1) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = 2) readonly buffer Hits { Hit hits[]; };
layout(std430, set = 0, binding = 3) readonly buffer Masks { uint masks[]; };
layout(std430, set = 0, binding = 4) readonly buffer Counts { uvec4 counts[]; };  // four chunks each
layout(std430, set = 0, binding = 5) writeonly buffer Total { ScanTotal found; };
// ContactRecord[], each written as two vectors: a software device then computes the address and the active lanes only
// once.
layout(std430, set = 0, binding = 6) writeonly buffer Contacts { uvec4 contacts[]; };
layout(push_constant) uniform Push { ContactsPush push; };

const uint sum_threads = contacts_group, sum_row = 8u;
#include "shaders/shared/sum_before.glsl"

shared uint before_group;  // contacts

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint group = gl_WorkGroupID.x;
  if (thread == 0u) {
    uint first = 0u, total = 0u;
    for (uint k = 0u; k < gl_NumWorkGroups.x / 4u; ++k) {
      const uvec4 four = counts[k];
      if (k == group / 4u) {
        first = total + (group % 4u > 0u ? four.x : 0u) + (group % 4u > 1u ? four.y : 0u) +
                (group % 4u > 2u ? four.z : 0u);
      }
      total += four.x + four.y + four.z + four.w;
    }
    before_group = first;
    if (group == 0u) {
      const uint groups = (total + contact_group - 1u) / contact_group;
      found = ScanTotal(total, clamp(groups, 1u, contacts_most_groups), 1u, 1u);  // one group sets up even if there are
                                                                                  // none
    }
  }

  const uint count = min(given.total, push.most_points);
  const uint chunk = points_per_chunk(count);
  const uint words = group * chunk < count ? chunk / 32u : 0u;  // contacts_find wrote no masks of empty chunks
  const uint first_word = group * chunk / 32u;
  const uint run = (words + contacts_group - 1u) / contacts_group;
  const uint begin = min(thread * run, words);
  const uint end = min(begin + run, words);
  uint mine = 0u;
  for (uint w = begin; w < end; ++w) mine += uint(bitCount(masks[first_word + w]));
  uint place = sum_before(mine);  // its barriers also make before_group valid
  if (mine == 0u) return;
  place += before_group;

  for (uint w = begin; w < end; ++w) {
    uint bits = masks[first_word + w];
    while (bits != 0u && place < push.most_contacts) {  // one bit less in each iteration
      const uint i = (first_word + w) * 32u + uint(findLSB(bits));
      bits &= bits - 1u;
      const uvec4 point = points[i];
      const Hit hit = hits[i];
      contacts[2u * place] = point;
      contacts[2u * place + 1u] = uvec4(hit.solid & ~hit_beyond, floatBitsToUint(hit.depth), 0u, hit.solid / hit_beyond);
      ++place;
    }
  }
}
