#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/shared/scan.h"

// Contacts, then deep points, as one list: the input of --cluster inside.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 2) readonly buffer DeepTotal { ScanTotal found_deep; };
layout(std430, set = 0, binding = 3) readonly buffer Deep { ContactRecord deep[]; };
layout(std430, set = 0, binding = 4) writeonly buffer InsideTotal { ScanTotal inside_total; };
layout(std430, set = 0, binding = 5) writeonly buffer Inside { ContactRecord inside[]; };
layout(push_constant) uniform Push { GatherPush push; };

void main() {
  const uint before = min(found.total, push.most_contacts);
  const uint count = before + min(found_deep.total, push.most_deep);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  if (gl_GlobalInvocationID.x == 0u) {
    const uint groups = clamp((count + contact_group - 1u) / contact_group, 1u, contacts_most_groups);
    inside_total = ScanTotal(count, groups, 1u, 1u);
  }
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    if (i < before) {
      inside[i] = contacts[i];
    } else {
      ContactRecord record = deep[i - before];
      record.deep = 1u;
      inside[i] = record;
    }
  }
}
