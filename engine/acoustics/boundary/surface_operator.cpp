#include "acoustics/boundary/surface_operator.hpp"

#include <utility>
#include <vector>

#include "acoustics/boundary/dense_lu.hpp"
#include "acoustics/boundary/galerkin.hpp"
#include "base/system/memory.hpp"

namespace palpa::acoustics {
namespace {

class DenseOperator : public SurfaceOperator {
 public:
  DenseOperator(std::vector<std::complex<float>> matrix, std::size_t size, const std::atomic<bool>* give_up)
      : size_(size), lu_(std::move(matrix), size, give_up) {}
  std::size_t unknowns() const override { return size_; }
  bool iterates() const override { return false; }
  SolveReport solve(Way way, std::span<std::complex<float>> columns, const std::atomic<bool>*) const override {
    lu_.solve(way, columns);
    return {};
  }

 private:
  std::size_t size_;
  DenseLu lu_;
};

}  // namespace

std::unique_ptr<SurfaceOperator> make_dense_operator(const Patches& body, double wave_number,
                                                     const std::atomic<bool>* give_up) {
  const std::size_t size = body.mesh.positions.size();
  std::vector<std::complex<float>> matrix;
  reserve_large(matrix, size * size);
  matrix.resize(size * size);
  assemble(body, wave_number, matrix, give_up);
  return std::make_unique<DenseOperator>(std::move(matrix), size, give_up);
}

std::uint64_t dense_operator_bytes(const geometry::Mesh& body) {
  const std::uint64_t vertices = body.positions.size();
  return vertices * vertices * sizeof(std::complex<float>) + assembly_bytes(body);
}

}  // namespace palpa::acoustics
