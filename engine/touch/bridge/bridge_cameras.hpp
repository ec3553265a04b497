// The cameras in the form that the bridge pass and its twin read.
#pragma once

#include <span>
#include <vector>

#include "sensing/camera.hpp"
#include "sensing/rays.hpp"
#include "shaders/touch/bridge/bridge.h"

namespace palpa::touch {

std::vector<shader::BridgeCamera> bridge_cameras(std::span<const sensing::Camera> cameras,
                                                 const sensing::RayTables& tables);

}  // namespace palpa::touch
