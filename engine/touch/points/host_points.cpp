#include "touch/points/host_points.hpp"

#include <algorithm>
#include <cstdint>

#include "touch/capacity.hpp"
#include "touch/contacts/contacts_twin.hpp"
#include "touch/pass_watch.hpp"

namespace palpa::touch {

HostPoints::HostPoints(const sensing::RayTables& tables, const PreparedSolids& solids, const StageSetting& setting)
    : tables_(tables), solids_(solids) {
  skin_.points.reserve(tables.pixels);
  const std::uint64_t points = tables.pixels != 0 ? tables.pixels : setting.most_points;
  const std::uint64_t most = setting.parameters.cluster == Cluster::inside ? 2 * default_contacts : default_contacts;
  reserve(clusters_, std::min(points, most));
}

void HostPoints::finish(Touch& out, std::vector<gpu::PassTime>& times) {
  PassWatch watch(times);
  std::span<const sensing::SkinPoint> points = frame_.points;
  out.dropped = {};
  if (tables_.pixels != 0) {
    sensing::find_skin(tables_, frame_.images, frame_.box, frame_.crops, frame_.volumes, skin_);
    points = skin_.points;
    out.dropped = skin_.dropped;
    watch.mark("skin");
  }
  find_contacts(points, solids_, frame_.parameters, frame_.reach, out);
  watch.mark("contacts");
  find_clusters(frame_.clustering, solids_, clusters_, out);
  watch.mark("clusters");
}

}  // namespace palpa::touch
