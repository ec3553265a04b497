#include "acoustics/compressed/body_operator.hpp"

#include "acoustics/compressed/fast_operator.hpp"

namespace palpa::acoustics {
namespace {

bool prefers_fast(const geometry::Mesh& body, double wave_number) {
  return body.positions.size() > most_dense_vertices &&
         fast_operator_bytes(body, wave_number) < dense_operator_bytes(body);
}

}  // namespace

std::unique_ptr<SurfaceOperator> make_operator(const Patches& body, double wave_number,
                                               const std::atomic<bool>* give_up) {
  return prefers_fast(body.mesh, wave_number) ? make_fast_operator(body, wave_number, give_up)
                                              : make_dense_operator(body, wave_number, give_up);
}

std::uint64_t operator_bytes(const geometry::Mesh& body, double wave_number) {
  return prefers_fast(body, wave_number) ? fast_operator_bytes(body, wave_number) : dense_operator_bytes(body);
}

}  // namespace palpa::acoustics
