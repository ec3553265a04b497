// The speed of palpa's computations on this machine. Every case checks its result against the C++ twins before it is
// timed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/row.hpp"
#include "geometry/gltf/gltf.hpp"
#include "gpu/device.hpp"

namespace palpa::bench {

/// A user's model for measure_surface.
struct Model {
  std::string name;
  geometry::Scene scene;
};
/// Reads a glTF file, and prepares its solids once, so that a bad file is refused before anything is measured. Throws
/// as load_gltf, make_solids and prepare_solids do.
Model load_model(const std::string& file);

struct Context {
  const gpu::Device& device;
  std::uint32_t runs = 200;
  std::optional<Model> model;  ///< measured as well by measure_surface
  std::function<void(const std::string& what, std::uint64_t done, std::uint64_t total)> progress;
};

/// Times `work` at most so many times: until it has taken a millisecond for each of context.runs, but at least three
/// times, or until it has taken three times as long.
std::vector<double> time_runs(const Context& context, const std::string& what, std::uint32_t most,
                              const std::function<void()>& work);

/// Depth frames in host memory to drives in host memory, one frame at a time.
void measure_loop(const Context& context, std::vector<Row>& rows);
/// Drives in batches and for one frame.
void measure_array(const Context& context, std::vector<Row>& rows);
/// Ten foci at once by each solver, on the device and by the twins: evenness, pressure and solves per second.
void measure_solvers(const Context& context, std::vector<Row>& rows);
/// Foci and nulls at once, on the host, which computes them on every device; of each case at most so many random sets.
void measure_nulls(const Context& context, std::vector<Row>& rows, std::uint32_t most_sets = 48);
/// The sound of a drive on a plane, on the device and on the host.
void measure_field(const Context& context, std::vector<Row>& rows);
/// Scattering by spheres, by the finger and by the hand, on the host: first the accuracy, then the time.
void measure_scattering(const Context& context, std::vector<Row>& rows);
/// Skin points to foci.
void measure_touch(const Context& context, std::vector<Row>& rows);
/// Methods and tuning, on the host.
void measure_methods(const Context& context, std::vector<Row>& rows);

/// Solids of many faces: time and memory for preparing one, from scratch and from the cache, and the contacts of a full
/// three-camera frame compared with those of the cube.
void measure_surface(const Context& context, std::vector<Row>& rows);
/// Its time and memory for preparing a scene's solids. Uses a cache of its own, and removes it.
void measure_preparation(const Context& context, const std::string& name, const geometry::Scene& scene,
                         std::vector<Row>& rows);

/// Resident memory of this process now, and the highest so far, in bytes.
std::uint64_t resident_bytes();
std::uint64_t peak_resident_bytes();

/// Throws failure(): a result is wrong, so its time would mean nothing.
[[noreturn]] void wrong(const std::string& what);
[[noreturn]] void twins_disagree(const std::string& name);

}  // namespace palpa::bench
