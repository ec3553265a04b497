#include "touch/points/host_points.hpp"

#include "touch/contacts/contacts_twin.hpp"
#include "touch/pass_watch.hpp"
#include "touch/points/clusters_twin.hpp"

namespace palpa::touch {

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
  find_clusters(frame_.clustering, solids_, out);
  watch.mark("clusters");
}

}  // namespace palpa::touch
