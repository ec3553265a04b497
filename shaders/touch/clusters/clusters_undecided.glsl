// The list of pairs of groups that stayed undecided. It uses the memory of links, which are no longer needed.

uint undecided_room(uint most_contacts) { return links_room(most_contacts) / 2u; }

// The number of groups along x in the dispatch of clusters_undecided once this pair is on the list.
uint undecided_groups(uint place) { return min(place + 1u, 65535u); }
