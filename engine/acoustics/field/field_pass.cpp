#include "acoustics/field/field_pass.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "array/drive_pass.hpp"
#include "base/activity.hpp"
#include "base/system/memory.hpp"
#include "base/system/parallel.hpp"
#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"
#include "spirv/field.comp.hpp"

namespace palpa::acoustics {

using array::Directivity;
using array::Layout;

static_assert(shader::field_directivity_steps == array::directivity_steps);

namespace {

gpu::ComputePipeline pipeline(const gpu::Device& device, Directivity directivity, bool absorbing) {
  const std::array<std::uint32_t, 2> constants{directivity != Directivity::omni, absorbing};
  return {device, "field", spirv::field_comp, sizeof(shader::FieldPush), constants};
}

}  // namespace

FieldPass::FieldPass(const gpu::Device& device, Directivity directivity, bool absorbing)
    : sum_(pipeline(device, directivity, absorbing)) {}

void FieldPass::record(VkCommandBuffer commands, const FieldBindings& bindings, const shader::FieldPush& push) const {
  assert(push.points <= most_points);
  if (push.points == 0) return;
  sum_.dispatch(commands, spirv::field_buffers(bindings), push,
                gpu::groups_for(push.points, shader::field_group * shader::field_each));
}

FieldMemory::FieldMemory(const gpu::Device& device, const Layout& layout, const Air& air, Directivity directivity,
                         std::size_t most_points)
    : layout_(&layout), turns_per_metre_(air.medium.turns_per_metre()) {
  const double radius = layout.transducer_radius_m * turns_per_metre_;
  push_.sources = static_cast<std::uint32_t>(layout.transducers.size());
  push_.nearest = std::max(static_cast<float>(radius), 1e-9F);
  push_.halvings = static_cast<float>(air.absorption_np_m / turns_per_metre_ * std::numbers::log2e);

  const std::vector<double> table = array::directivity_table(directivity, 2 * std::numbers::pi * radius);
  directivity_ = gpu::Upload(device, array::directivity_steps * sizeof(shader::FieldStep), "field directivity");
  for (std::size_t i = 0; i < array::directivity_steps; ++i) {
    directivity_.as<shader::FieldStep>()[i] = {static_cast<float>(table[i]),
                                               static_cast<float>(table[i + 1] - table[i])};
  }
  directivity_texels_ = gpu::TexelView(device, directivity_.ref(), VK_FORMAT_R32G32_UINT, "field directivity");
  sources_ = gpu::Upload(device, std::max(1U, push_.sources) * sizeof(shader::FieldSource), "field sources");
  source_texels_ = gpu::TexelView(device, sources_.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "field sources");
  points_ = gpu::Upload(device, most_points * sizeof(shader::FieldPoint), "field points");
  pressures_ = gpu::Readback(device, most_points * sizeof(shader::FieldPressure), "field pressures");
}

void FieldMemory::set(std::span<const std::complex<double>> strengths) {
  assert(strengths.size() == layout_->transducers.size());
  // Converts a pressure in 1/wavelength to 1/m.
  const double level = layout_->source_level_pa_m * turns_per_metre_;
  for (std::size_t t = 0; t < strengths.size(); ++t) {
    const auto& [position, axis] = layout_->transducers[t];
    const shader::DrivePoint place = array::drive_point(position, turns_per_metre_);
    shader::FieldSource& source = sources_.as<shader::FieldSource>()[t];
    source = {place.coarse,
              place.fine,
              {static_cast<float>(axis.x), static_cast<float>(axis.y), static_cast<float>(axis.z), 0}};
    source.coarse.w = static_cast<float>(level * strengths[t].real());
    source.fine.w = static_cast<float>(level * strengths[t].imag());
  }
}

void FieldMemory::record(VkCommandBuffer commands, const FieldPass& pass, std::span<const Vec3> points) {
  push_.points = static_cast<std::uint32_t>(points.size());
  std::ranges::transform(points, points_.as<shader::FieldPoint>().begin(), [&](const Vec3& point) {
    const shader::DrivePoint place = array::drive_point(point, turns_per_metre_);
    return shader::FieldPoint{place.coarse, place.fine};
  });
  // The previous submit wrote and read the same memory; see gpu/barrier.hpp.
  gpu::compute_to_compute(commands);
  sources_.record(commands);
  directivity_.record(commands);
  points_.record(commands, points.size() * sizeof(shader::FieldPoint));
  pass.record(commands, {source_texels_.ref(), points_.ref(), directivity_texels_.ref(), pressures_.ref()}, push_);
  pressures_.record(commands, points.size() * sizeof(shader::FieldPressure));
}

void FieldMemory::read(std::span<std::complex<double>> pressures) const {
  std::ranges::transform(pressures_.as<shader::FieldPressure>().first(pressures.size()), pressures.begin(),
                         [](const shader::FieldPressure& p) { return std::complex<double>(p.re, p.im); });
}

std::size_t field_batch(std::size_t transducers) {
  // Pairs of a point and a transducer in one submit: about a quarter of a second on two cores.
  constexpr std::size_t pairs = std::size_t{1} << 27, least = std::size_t{shader::field_group} * shader::field_each;
  constexpr std::size_t most = (std::size_t{1} << 20) / least * least;
  static_assert(most <= FieldPass::most_points && most * sizeof(shader::FieldPoint) <= std::size_t{128} << 20);
  return std::clamp(pairs / std::max<std::size_t>(transducers, 1) / least * least, least, most);
}

FieldOn::FieldOn(const gpu::Device& device, Directivity directivity, bool absorbing)
    : device_(&device),
      directivity_(directivity),
      pass_(device, directivity, absorbing),
      recorder_(device, "field"),
      timeline_(device) {}

bool FieldOn::at(const Layout& layout, const Air& air, std::span<const Vec3> points,
                 std::span<const std::complex<double>> strengths, std::vector<std::complex<double>>& pressures,
                 const std::atomic<bool>* give_up) {
  reserve_large(pressures, points.size());
  pressures.assign(points.size(), 0);
  if (points.empty() || layout.transducers.empty()) return true;
  const std::size_t batch = field_batch(layout.transducers.size());
  FieldMemory memory(*device_, layout, air, directivity_, std::min(batch, points.size()));
  memory.set(strengths);
  Activity activity("summing the sound of transducers", points.size());
  for (std::size_t first = 0; first < points.size(); first += batch) {
    if (give_up && *give_up) return false;
    const std::size_t count = std::min(batch, points.size() - first);
    memory.record(recorder_.begin(), pass_, points.subspan(first, count));
    timeline_.wait(timeline_.submit(recorder_.end()));
    memory.read(std::span(pressures).subspan(first, count));
    activity.advance(count);
  }
  return true;
}

bool field_on(const gpu::Device& device, const Layout& layout, const Air& air, Directivity directivity,
              std::span<const Vec3> points, std::span<const std::complex<double>> strengths,
              std::vector<std::complex<double>>& pressures, const std::atomic<bool>* give_up) {
  return FieldOn(device, directivity, air.absorption_np_m != 0).at(layout, air, points, strengths, pressures, give_up);
}

}  // namespace palpa::acoustics
