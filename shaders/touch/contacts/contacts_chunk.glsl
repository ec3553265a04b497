// Points per group of a dispatch with a group per chunk, in whole rounds of its threads (which are whole words of 32
// points).
uint points_per_chunk(uint points) {
  const uint round_of_all = gl_NumWorkGroups.x * contacts_group;
  return (points + round_of_all - 1u) / round_of_all * contacts_group;
}
