#include "viewer/picture/outline.hpp"

namespace palpa::viewer {

void Outliner::find(const EdgeNet& net, const shader::vec4& eye, std::vector<shader::ViewEdge>& lines) {
  in_front_.resize(net.planes.size());
  for (std::size_t i = 0; i < net.planes.size(); ++i) {
    const shader::vec4& p = net.planes[i];
    in_front_[i] = p.x * eye.x + p.y * eye.y + p.z * eye.z > p.w * eye.w ? 1 : 0;
  }
  for (const EdgeNet::Fold& fold : net.folds) {
    if (in_front_[fold.left] != in_front_[fold.right]) lines.push_back({net.ends[fold.from], net.ends[fold.to]});
  }
}

}  // namespace palpa::viewer
