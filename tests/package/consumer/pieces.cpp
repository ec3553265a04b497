// The pieces of C++ on the pages that are no files of their own. Each is compiled as it is printed, in a function that
// has what is the reader's.
#include <cstdio>

#include "byte_link.hpp"
#include "geometry/gltf/gltf.hpp"
#include "gpu/device.hpp"
#include "session/links/safe_link.hpp"
#include "session/session.hpp"

bool track(std::vector<glm::vec3>& skin, double& time_s);
void pressed(const std::string& solid, std::uint32_t finger);
void released(std::uint32_t finger);

void readme(const std::vector<glm::vec3>& skin, double time_s) {
#include "pieces/readme"
}

void touch_events(std::vector<glm::vec3> skin, double time_s) {
#include "pieces/touch_events"
}

void on_the_gpu(std::vector<palpa::geometry::Solid> solids) {
#include "pieces/on_the_gpu"
}

void a_link_of_my_own(const palpa::array::Layout& layout, const std::vector<std::string>& solid_names, double slot_s) {
#include "pieces/link"
}
