// The cameras in the form in which fingers look at their pictures.
#pragma once

#include <span>
#include <vector>

#include "sensing/camera.hpp"
#include "sensing/rays.hpp"
#include "touch/fingers/bridge_math.hpp"

namespace palpa::touch {

std::vector<BridgeCamera> bridge_cameras(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables);

}  // namespace palpa::touch
