#include "geometry/parts/vhacd.hpp"

#include "base/error.hpp"
#include "base/system/start_thread.hpp"

#ifdef PALPA_VHACD

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>

#define ENABLE_VHACD_IMPLEMENTATION 1
#include <VHACD.h>

namespace palpa::geometry {
namespace {

/// State shared by the computing thread and the waiting thread; the last of them frees it.
struct Job : VHACD::IVHACD::IUserCallback {
  std::vector<double> points;
  std::vector<std::uint32_t> triangles;
  VHACD::IVHACD::Parameters parameters;
  std::atomic<double> fraction{0};
  std::atomic<bool> cancelled{false}, done{false};
  std::mutex mutex;  ///< guards the next two
  VHACD::IVHACD* worker = nullptr;
  std::exception_ptr fault;
  std::vector<std::vector<Vec3>> hulls;  ///< valid once `done`

  void Update(double overall, double stage, const char*, const char*) override {
    // There are ten stages; `overall` is the percentage of finished stages.
    const double now = (overall + std::min(stage, 100.0) / 10) / 100;
    if (now > fraction) fraction = std::min(now, 1.0);
  }
};

struct Release {
  void operator()(VHACD::IVHACD* worker) const { worker->Release(); }
};

void compute(Job& job) {
  // V-HACD counts its hulls in a global variable.
  static std::mutex one_at_a_time;
  const std::lock_guard turn(one_at_a_time);
  const std::unique_ptr<VHACD::IVHACD, Release> worker(VHACD::CreateVHACD());
  {
    const std::lock_guard lock(job.mutex);
    job.worker = worker.get();
  }
  const bool finished =
      !job.cancelled &&
      worker->Compute(job.points.data(), static_cast<std::uint32_t>(job.points.size() / 3), job.triangles.data(),
                      static_cast<std::uint32_t>(job.triangles.size() / 3), job.parameters);
  {
    const std::lock_guard lock(job.mutex);
    job.worker = nullptr;
  }
  if (!finished) return;
  for (std::uint32_t i = 0; i < worker->GetNConvexHulls(); ++i) {
    VHACD::IVHACD::ConvexHull hull;
    if (!worker->GetConvexHull(i, hull)) continue;
    std::vector<Vec3> corners;
    for (const VHACD::Vertex& v : hull.m_points)
      corners.emplace_back(v.mX, v.mY, v.mZ);
    job.hulls.push_back(std::move(corners));
  }
}

void run(const std::shared_ptr<Job>& job) {
  try {
    compute(*job);
  } catch (...) {
    job->fault = std::current_exception();
  }
  job->done = true;
}

/// V-HACD stores vertices in an unbalanced tree and descends by recursion: in the worst case one level, of slightly
/// more than 100 bytes, for each vertex. Its other recursions halve their input.
constexpr std::size_t stack_per_vertex = 256, stack_besides = std::size_t{8} << 20;

void* run_job(void* argument) {
  const std::unique_ptr<std::shared_ptr<Job>> job(static_cast<std::shared_ptr<Job>*>(argument));
  run(*job);
  return nullptr;
}

/// Like std::thread, with a stack as deep as the job may need. The system only allocates the pages that are touched.
pthread_t start(const std::shared_ptr<Job>& job) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_besides + job->points.size() / 3 * stack_per_vertex);
  auto own = std::make_unique<std::shared_ptr<Job>>(job);
  pthread_t thread{};
  const int fault = pthread_create(&thread, &attributes, run_job, own.get());
  pthread_attr_destroy(&attributes);
  if (fault != 0) throw no_thread("taking a mesh apart", std::system_error(fault, std::generic_category()));
  static_cast<void>(own.release());
  return thread;
}

}  // namespace

std::vector<std::vector<Vec3>> vhacd_hulls(const Mesh& mesh, const VhacdOptions& options, const Progress& progress) {
  const auto job = std::make_shared<Job>();
  for (const Vec3& p : mesh.positions)
    job->points.insert(job->points.end(), {p.x, p.y, p.z});
  // V-HACD's rays take a voxel for an inner one if they meet faces from the side that their triangles turn
  // counter-clockwise.
  for (const glm::uvec3& t : mesh.triangles)
    job->triangles.insert(job->triangles.end(), {t[0], t[options.cavities ? 2 : 1], t[options.cavities ? 1 : 2]});
  VHACD::IVHACD::Parameters& p = job->parameters;
  p.m_callback = job.get();
  p.m_maxConvexHulls = options.parts;
  p.m_resolution = options.resolution;
  p.m_minimumVolumePercentErrorAllowed = options.error_percent;
  p.m_maxNumVerticesPerCH = options.vertices;
  p.m_fillMode = options.cavities ? VHACD::FillMode::RAYCAST_FILL : VHACD::FillMode::FLOOD_FILL;
  p.m_asyncACD = false;

  const pthread_t worker = start(job);
  while (!job->done) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (!progress || progress(job->fraction)) continue;
    job->cancelled = true;
    {
      const std::lock_guard lock(job->mutex);
      if (job->worker) job->worker->Cancel();
    }
    pthread_detach(worker);
    return {};
  }
  pthread_join(worker, nullptr);
  if (job->fault) std::rethrow_exception(job->fault);
  return std::move(job->hulls);
}

}  // namespace palpa::geometry

#else

namespace palpa::geometry {

std::vector<std::vector<Vec3>> vhacd_hulls(const Mesh&, const VhacdOptions&, const Progress&) {
  throw failure(how_to_get_vhacd());
}

}  // namespace palpa::geometry

#endif

namespace palpa::geometry {

const char* how_to_get_vhacd() {
  return "this palpa was built without V-HACD, which makes the parts: install npm and build again, or give cmake "
         "-DPALPA_VHACD_HEADER=/path/to/VHACD.h";
}

}  // namespace palpa::geometry
