// The C++ pieces of the pages that are not separate files. Each is compiled as it is printed, in a function that has
// the names that the reader provides.
#include <cstdio>

#include "byte_link.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/gltf/gltf.hpp"
#include "gpu/device.hpp"
#include "session/links/safe_link.hpp"
#include "session/session.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"
#include "setup/tasks/scatter.hpp"
#include "setup/tasks/simulate.hpp"
#include "setup/tasks/touch.hpp"

bool track(std::vector<glm::vec3>& skin, double& time_s);
void pressed(const std::string& solid, std::uint32_t finger);
void released(std::uint32_t finger);
void show(const palpa::Vec3& place, double value = 0);
void save(const std::string& json);
void push(const palpa::Vec3& force, const palpa::Vec3& torque);

void readme(const std::vector<glm::vec3>& skin, double time_s) {
#include "pieces/readme"
}

void touch_events(std::vector<glm::vec3> skin, double time_s) {
#include "pieces/touch_events"
}

void on_the_gpu(std::vector<palpa::geometry::Solid> solids) {
#include "pieces/on_the_gpu"
}

void what_commands_compute() {
#include "pieces/sound_tasks"
}

void a_link_of_my_own(const palpa::array::Layout& layout, const std::vector<std::string>& solid_names, double slot_s) {
#include "pieces/link"
}

void a_touch(const std::vector<palpa::Vec3>& points) {
#include "pieces/touch_task"
}

void a_simulated_touch() {
#include "pieces/simulate_task"
}
