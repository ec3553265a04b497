// The list of pairs of groups that stayed undecided, in the memory of links, which are done with.

uint undecided_room(uint most_contacts) { return links_room(most_contacts) / 2u; }

// Groups that fingers_undecided takes along x when this pair is on the list.
uint undecided_groups(uint place) { return min(place + 1u, 65535u); }
