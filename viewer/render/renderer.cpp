#include "viewer/render/renderer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "shaders/viewer/view_scene.h"
#include "viewer/picture/detail.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/render/overlay.hpp"
#include "viewer/render/rendering.hpp"
#include "viewer/view/vec4.hpp"

namespace palpa::viewer {
namespace {

/// A thousandth of the distance, so that lines lie on their surface and not half in it.
constexpr float line_bias = 1.0e-3f;

/// For the plane of a cross-section, which has its finger's colour.
constexpr float section_alpha = 0.22f;

Colour face_of(const SurfaceItems& solid, const Theme& theme) {
  return solid.part ? part_colour(theme.solid, *solid.part) : theme.solid;
}

Colour rim_of(const SurfaceItems& solid, const Theme& theme) {
  return solid.part ? part_colour(theme.solid_rim, *solid.part) : theme.solid_rim;
}

VkFormat pick_depth_format(const gpu::Device& device) {
  for (const VkFormat format : {VK_FORMAT_D32_SFLOAT, VK_FORMAT_X8_D24_UNORM_PACK32}) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
    if (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) return format;
  }
  return VK_FORMAT_D16_UNORM;  // every device has it
}

VkSampleCountFlagBits pick_samples(const gpu::Device& device) {
  const auto& limits = device.limits();
  const auto both = limits.framebufferColorSampleCounts & limits.framebufferDepthSampleCounts;
  static_assert(VK_SAMPLE_COUNT_4_BIT == shader::view_samples);
  return both & VK_SAMPLE_COUNT_4_BIT ? VK_SAMPLE_COUNT_4_BIT : VK_SAMPLE_COUNT_1_BIT;
}

void refuse_what_cannot_draw(const gpu::Device& device) {
  const gpu::DeviceDescription& d = device.description();
  if (d.cannot_draw) {
    throw Error(Exit::no_device,
                fmt::format("{} ({}) cannot draw: set LP_NATIVE_VECTOR_WIDTH=256, or choose another device with --gpu",
                            d.name, d.driver));
  }
}

/// Uploads overwrite data that the draws of earlier frames have fetched.
void after_last_draws(VkCommandBuffer commands) {
  constexpr VkPipelineStageFlags2 draws = VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
                                          VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
  gpu::barrier(commands, draws, 0, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, 0);
}

constexpr std::uint32_t corners_of(std::uint32_t quads) {
  return quads * 6;
}

/// The largest size in pixels at which a metre appears within `box`.
double pixels_per_metre(const shader::ViewPush& push, const Box& box) {
  double nearest = 1e30;
  const shader::vec4& w = push.clip_w;
  for (const Vec3& p : box.corners()) {
    if (!box.empty()) nearest = std::min(nearest, w.x * p.x + w.y * p.y + w.z * p.z + w.w);
  }
  return static_cast<double>(push.window.z) / std::max(nearest, 1e-9);
}

/// Crowded skin points hide each other. Drawing every n-th of them leaves enough for every pixel.
std::uint32_t point_step(const shader::ViewPush& push, const Box& box, std::uint32_t count) {
  constexpr double enough = 4;  // for each pixel
  if (box.empty()) return 1;
  double left = 1e30, right = -1e30, top = 1e30, bottom = -1e30;
  for (const Vec3& corner : box.corners()) {
    const Projected p = project(push, corner);
    if (!p.visible) return 1;
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  const double pixels = std::max(right - left, 1.0) * std::max(bottom - top, 1.0);
  return static_cast<std::uint32_t>(std::clamp(count / (enough * pixels), 1.0, 64.0));
}

/// The same for a quick picture.
constexpr std::uint32_t most_quick_points = 32768;

/// The fewest triangles with at most that error.
Items corners_for(const SurfaceItems& surface, double error_m) {
  Items corners = surface.corners;
  for (const CoarserItems& coarser : surface.coarser) {
    if (coarser.error_m <= error_m) corners = coarser.corners;
  }
  return corners;
}

/// The eye as seen from something that is displaced by `by` from its coordinates.
shader::vec4 seen_from(shader::vec4 eye, const Vec3& by) {
  const glm::vec3 d(by);
  if (eye.w > 0.5f) eye = {eye.x - d.x, eye.y - d.y, eye.z - d.z, eye.w};
  return eye;
}

}  // namespace

struct Renderer::Shot {
  Rendering& on;
  const ViewPipelines& with;
  Fineness fineness;
  shader::ViewPush push;  // projection, window and eye; colour and style are each draw's own
  const Theme& theme;
  const Layers& layers;
  Vec3 eye;
  float ratio;

  /// For something that is displaced by `by` from its coordinates.
  Shot moved(const Vec3& by) const {
    Shot shot = *this;
    const glm::vec3 d(by);
    for (shader::vec4* clip : {&shot.push.clip_x, &shot.push.clip_y, &shot.push.clip_z, &shot.push.clip_w})
      clip->w += clip->x * d.x + clip->y * d.y + clip->z * d.z;
    shot.push.eye = seen_from(push.eye, by);
    return shot;
  }
};

Renderer::Renderer(const gpu::Device& device, VkFormat colour)
    : device_(&device), colour_(colour), depth_(pick_depth_format(device)), most_samples_(pick_samples(device)) {
  refuse_what_cannot_draw(device);
}

VkSampleCountFlagBits Renderer::samples_of(Fineness fineness) const {
  return fineness == Fineness::fine ? most_samples_ : VK_SAMPLE_COUNT_1_BIT;
}

Canvas Renderer::make_canvas(VkExtent2D extent, Fineness fineness) {
  const VkSampleCountFlagBits samples = samples_of(fineness);
  std::unique_ptr<const ViewPipelines>& pipelines = samples == VK_SAMPLE_COUNT_1_BIT ? single_ : several_;
  if (!pipelines)
    pipelines = std::make_unique<const ViewPipelines>(make_view_pipelines(*device_, colour_, depth_, samples));
  Canvas canvas;
  canvas.pipelines_ = pipelines.get();
  canvas.fineness_ = fineness;
  constexpr VkImageUsageFlags transient = VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
  canvas.depth_ = gpu::Image(
      *device_, {extent, depth_, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | transient, samples}, "view depth");
  if (samples != VK_SAMPLE_COUNT_1_BIT) {
    canvas.colour_ = gpu::Image(*device_, {extent, colour_, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | transient, samples},
                                "view samples");
  }
  return canvas;
}

View whole(const Viewpoint& viewpoint, std::uint32_t width, std::uint32_t height) {
  return {viewpoint, {{0, 0}, {width, height}}, false};
}

View close_up(const Viewpoint& viewpoint, const Box& box, std::uint32_t width, std::uint32_t height, double ratio) {
  const double w = inset_share * width, h = std::min(0.5 * height, w);
  const double margin = std::min(24 * ratio, 0.04 * height), below = std::min(64 * ratio, 0.1 * height);
  View view{viewpoint, {}, true};
  view.area.extent = {static_cast<std::uint32_t>(w), static_cast<std::uint32_t>(h)};
  view.area.offset = {static_cast<std::int32_t>(width - w - margin), static_cast<std::int32_t>(height - h - below)};
  view.viewpoint.covered_left = view.viewpoint.covered_right = view.viewpoint.covered_below = 0;
  fit(view.viewpoint, box, w / h);
  return view;
}

// Which strokes belong to which view.
std::vector<Items> Renderer::upload_overlay(VkCommandBuffer commands, const DrawnPicture& drawn,
                                            std::span<const View> views, Canvas& canvas, double ratio) const {
  canvas.strokes_.clear();
  std::vector<Items> ranges;
  for (const View& view : views) {
    const auto first = static_cast<std::uint32_t>(canvas.strokes_.size());
    build_overlay(
        drawn.picture_, drawn.state_, view.viewpoint,
        {static_cast<double>(view.area.extent.width), static_cast<double>(view.area.extent.height), ratio, view.inset},
        canvas.strokes_);
    ranges.push_back({first, static_cast<std::uint32_t>(canvas.strokes_.size()) - first});
  }
  canvas.overlay_.record(commands, canvas.overlay_.fill(*device_, canvas.strokes_, "view overlay"));
  return ranges;
}

// Empty if edges are hidden. Otherwise the edges of every surface in the first view, then in the next.
std::vector<Renderer::EdgeLines> Renderer::upload_edges(VkCommandBuffer commands, const DrawnPicture& drawn,
                                                        std::span<const View> views, Canvas& canvas) const {
  std::vector<EdgeLines> lines;
  if (!drawn.state_.layers.shows(Layer::edges)) return lines;
  std::vector<shader::ViewEdge>& edges = canvas.edges_;
  edges.clear();
  for (const View& view : views) {
    const shader::vec4 eye = projection(view.viewpoint, 1, 1).eye;
    for (const SurfaceItems& solid : drawn.solids_) {
      const auto first = static_cast<std::uint32_t>(edges.size());
      edges.insert(edges.end(), solid.edges.creases.begin(), solid.edges.creases.end());
      canvas.outliner_.find(solid.edges, seen_from(eye, drawn.state_.explode * solid.away), edges);
      lines.push_back({{first, static_cast<std::uint32_t>(edges.size()) - first},
                       static_cast<std::uint32_t>(solid.edges.creases.size())});
    }
  }
  canvas.lines_.record(commands, canvas.lines_.fill(*device_, edges, "view edges"));
  return lines;
}

VkCommandBuffer Renderer::record(VkCommandBuffer commands, DrawnPicture& drawn, std::span<const View> views,
                                 Canvas& canvas, const Target& target, double ratio, const Sheet* sheet,
                                 const NextStep& next) const {
  const VkExtent2D extent = canvas.extent();
  const Theme& theme = theme_of(drawn.state_.dark);
  after_last_draws(commands);
  drawn.record_upload(commands);
  const std::vector<Items> overlays = upload_overlay(commands, drawn, views, canvas, ratio);
  const std::vector<EdgeLines> lines = upload_edges(commands, drawn, views, canvas);
  if (sheet) canvas.pipelines_->sheets.upload(commands, *sheet, canvas.sheet_);

  const bool resolve = canvas.colour_.get() != VK_NULL_HANDLE;
  gpu::transition(commands, target.image, colour_, gpu::image_use::discard_colour, gpu::image_use::colour_target);
  gpu::transition(commands, canvas.depth_.get(), depth_, gpu::image_use::discard_depth, gpu::image_use::depth_target);
  if (resolve) {
    gpu::transition(commands, canvas.colour_.get(), colour_, gpu::image_use::discard_colour,
                    gpu::image_use::colour_target);
  }

  const Rendering::Images images{extent, target.view, canvas.colour_.view(), canvas.depth_.view()};
  // If there are very many parts, each takes little time.
  Rendering rendering(commands, images, theme.background, next, 1 + drawn.solids_.size() / 8);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const VkExtent2D size = views[i].area.extent;
    Shot shot{rendering,
              *canvas.pipelines_,
              canvas.fineness_,
              projection(views[i].viewpoint, size.width, size.height),
              theme,
              drawn.state_.layers,
              basis(views[i].viewpoint).eye,
              static_cast<float>(ratio)};
    shot.push.style.z = static_cast<float>(views[i].area.offset.x);
    shot.push.style.w = static_cast<float>(views[i].area.offset.y);
    const std::size_t solids = lines.empty() ? 0 : drawn.solids_.size();
    draw_view(shot, drawn, canvas, views[i], overlays[i], std::span(lines).subspan(i * solids, solids));
  }
  if (sheet) canvas.pipelines_->sheets.draw(rendering.commands(), *sheet, canvas.sheet_, extent);
  return rendering.end();
}

void Renderer::draw_view(const Shot& shot, const DrawnPicture& drawn, const Canvas& canvas, const View& view,
                         const Items& overlay, std::span<const EdgeLines> lines) const {
  const VkRect2D& area = view.area;
  shot.on.set_area(area);
  if (view.inset) {
    std::array<VkClearAttachment, 2> clears{};
    clears[0].aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    clears[0].clearValue.color = {{shot.theme.background.r, shot.theme.background.g, shot.theme.background.b, 1.0f}};
    clears[1].aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT;
    const VkClearRect rect{area, 0, 1};
    vkCmdClearAttachments(shot.on.commands(), 2, clears.data(), 1, &rect);
  }
  draw_points(shot, drawn);
  draw_images(shot, drawn, view);
  draw_faces_and_lines(shot, drawn);
  draw_surfaces(shot, drawn, canvas, lines);
  draw_overlay(shot, canvas, overlay);
}

// Points are opaque and come first. They write depth, so translucent surfaces then blend over the points behind them.
void Renderer::draw_points(const Shot& shot, const DrawnPicture& drawn) const {
  const auto draw = [&](const Items& range, float outline, Layer layer, std::uint32_t each) {
    if (!shot.layers.shows(layer)) return;
    shader::ViewPush push = shot.push;
    push.style = {outline * shot.ratio, shot.ratio, shot.layers.opacity(layer), static_cast<float>(each)};
    shot.on.draw(shot.with.disc, {drawn.discs_.ref()}, push, {.depth_write = true}, 3 * (range.count / each),
                 3 * (range.first / each));
  };
  draw(drawn.transducers_, 0.0f, Layer::transducers, 1);
  const std::uint32_t points = drawn.points_.count;
  std::uint32_t each = point_step(shot.push, drawn.points_box_, points);
  if (shot.fineness == Fineness::quick) each = std::max(each, (points + most_quick_points - 1) / most_quick_points);
  draw(drawn.points_, 0.0f, Layer::points, each);
  draw(drawn.contacts_, 0.6f, Layer::contacts, 1);
}

// Images that hide what is behind them also write depth. Seen from within a camera, its own image would hide everything
// else.
void Renderer::draw_images(const Shot& shot, const DrawnPicture& drawn, const View& view) const {
  for (const ImageItems& image : drawn.images_) {
    if (image.layer == Layer::depth && view.viewpoint.frustum) continue;
    const float opacity = shot.layers.opacity(image.layer);
    shader::ViewPush push = shot.push;
    push.style = {static_cast<float>(image.first_pixel), static_cast<float>(image.width),
                  static_cast<float>(image.height), opacity};
    shot.on.draw(shot.with.image, {drawn.face_vertices_.ref(), drawn.pixels_.ref()}, push,
                 {.depth_write = opacity >= 1}, image.vertices.count, image.vertices.first);
  }
}

void Renderer::draw_faces_and_lines(const Shot& shot, const DrawnPicture& drawn) const {
  const float tile = shot.layers.opacity(Layer::tile);
  shader::ViewPush flat = shot.push;
  flat.colour.w = flat.style.x = tile;
  flat.style.y = flat.style.z = 0;
  shot.on.draw(shot.with.mesh, {drawn.face_vertices_.ref()}, flat, {.depth_write = tile >= 1}, drawn.tile_.count,
               drawn.tile_.first);
  shader::ViewPush push = shot.push;
  push.window.w = line_bias;
  push.style = {0, shot.ratio, shot.push.style.z, shot.push.style.w};
  shot.on.draw(shot.with.stroke, {drawn.strokes_.ref()}, push, {}, corners_of(drawn.lines_.count));
  push = shot.push;
  const float board = shot.theme.board.a * shot.layers.opacity(Layer::transducers);
  push.colour = vec4_of(with_alpha(shot.theme.board, board));
  push.style = {board, 0, 0, 0};
  shot.on.draw(shot.with.mesh, {drawn.face_vertices_.ref()}, push, {}, drawn.boards_.count);
  const float section = section_alpha * shot.layers.opacity(Layer::sections);
  push.colour.w = push.style.x = section;
  shot.on.draw(shot.with.mesh, {drawn.face_vertices_.ref()}, push, {}, drawn.sections_.count, drawn.sections_.first);
}

/// A solid, or a part of one, where it is drawn.
struct Renderer::Part {
  const SurfaceItems* items;
  EdgeLines lines;
  Vec3 away;
  double distance;
};

std::vector<Renderer::Part> Renderer::parts_from_far(const Shot& shot, const DrawnPicture& drawn,
                                                     std::span<const EdgeLines> lines) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < drawn.solids_.size(); ++i) {
    const SurfaceItems& solid = drawn.solids_[i];
    const Vec3 away = drawn.state_.explode * solid.away;
    parts.push_back({&solid, lines.empty() ? EdgeLines{} : lines[i], away,
                     solid.bounds.empty() ? 0 : glm::distance(solid.bounds.centre() + away, shot.eye)});
  }
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.distance > b.distance; });
  return parts;
}

// Solids are convex, so back faces and then front faces blend in the right order. Several solids are drawn from far to
// near. The skin's surface may pass through a solid: its part behind the solid's front is drawn before that front, the
// rest after.
void Renderer::draw_surfaces(const Shot& all, const DrawnPicture& drawn, const Canvas& canvas,
                             std::span<const EdgeLines> lines) const {
  const auto memory_of = [&](const SurfaceItems& surface) -> const SurfaceMemory& {
    return &surface == &drawn.skin_ ? drawn.skin_memory_ : drawn.solids_memory_;
  };
  const auto run_of = [&](const Shot& shot, const SurfaceItems& surface) {
    const Items corners = corners_for(surface, least_pixels / pixels_per_metre(shot.push, surface.bounds));
    return gpu::GraphicsPipeline::Run{memory_of(surface).corners.ref(), corners.first, corners.count};
  };
  const auto paint = [&](const Shot& shot, const SurfaceItems& surface, Colour face, Colour rim, float opacity,
                         const gpu::DrawState& state) {
    shader::ViewPush push = shot.push;
    push.colour = vec4_of(with_alpha(face, face.a * opacity));
    push.style = {rim.a * opacity, 1, 1, 0};
    shot.on.draw(shot.with.mesh, {memory_of(surface).vertices.ref()}, push, state, run_of(shot, surface));
  };
  const bool heat = drawn.skin_has_colours_ && all.layers.shows(Layer::heat);
  if (heat) draw_heat(all, drawn);
  const auto paint_skin = [&](VkCompareOp compare) {
    if (heat || !all.layers.shows(Layer::skin)) return;
    for (const VkCullModeFlagBits hidden : {VK_CULL_MODE_FRONT_BIT, VK_CULL_MODE_BACK_BIT}) {
      paint(all, drawn.skin_, all.theme.skin, all.theme.skin_rim, all.layers.opacity(Layer::skin),
            {.cull = hidden, .compare = compare});
    }
  };

  const std::vector<Part> parts = parts_from_far(all, drawn, lines);
  const float opacity = all.layers.opacity(Layer::solids);
  const auto paint_faces = [&](const Part& part, VkCullModeFlags hidden) {
    if (opacity > 0) {
      paint(all.moved(part.away), *part.items, face_of(*part.items, all.theme), rim_of(*part.items, all.theme), opacity,
            {.cull = hidden});
    }
  };
  const bool edges = all.layers.shows(Layer::edges);
  for (const Part& part : parts) {
    paint_faces(part, VK_CULL_MODE_FRONT_BIT);
    if (opacity > 0 || edges)
      all.on.draw(all.with.mesh_depth, {drawn.solids_memory_.vertices.ref()}, all.moved(part.away).push,
                  {.cull = VK_CULL_MODE_BACK_BIT, .depth_write = true}, run_of(all.moved(part.away), *part.items));
  }
  if (!parts.empty()) paint_skin(VK_COMPARE_OP_LESS);
  for (const Part& part : parts) {
    paint_faces(part, VK_CULL_MODE_BACK_BIT);
    if (edges) draw_edges(all.moved(part.away), canvas, part.lines);
  }
  paint_skin(VK_COMPARE_OP_GREATER_OR_EQUAL);
}

// Hardly shaded, so that colours stay the same as in the bar.
void Renderer::draw_heat(const Shot& shot, const DrawnPicture& drawn) const {
  const float opacity =
      shot.layers.opacity(Layer::heat) * (is_stale(drawn.picture_, Layer::heat) ? stale_opacity : 1.0f);
  shader::ViewPush push = shot.push;
  push.colour.w = opacity;
  push.style = {opacity, 0.25f, 0, 0};
  shot.on.draw(shot.with.mesh, {drawn.skin_memory_.vertices.ref()}, push,
               {.cull = VK_CULL_MODE_BACK_BIT, .depth_write = opacity >= 1},
               {drawn.skin_memory_.corners.ref(), drawn.skin_.corners.first, drawn.skin_.corners.count});
}

// Lines in front of the surface are firm, creases behind it are faint. Behind it, the folds of a dense mesh would only
// be a tangle.
void Renderer::draw_edges(const Shot& shot, const Canvas& canvas, const EdgeLines& lines) const {
  shader::ViewPush push = shot.push;
  push.window.w = line_bias;
  const auto draw = [&](float width, float alpha, VkCompareOp compare, std::uint32_t count) {
    push.colour = vec4_of(with_alpha(shot.theme.edge, alpha * shot.layers.opacity(Layer::edges)));
    push.style = {0.5f * width * shot.ratio, 0, shot.push.style.z, shot.push.style.w};
    shot.on.draw(shot.with.edge, {canvas.lines_.ref()}, push, {.compare = compare}, corners_of(count),
                 corners_of(lines.all.first));
  };
  draw(1.0f, 0.30f, VK_COMPARE_OP_LESS, lines.creases);
  draw(1.5f, 0.90f, VK_COMPARE_OP_GREATER_OR_EQUAL, lines.all.count);
}

void Renderer::draw_overlay(const Shot& shot, const Canvas& canvas, const Items& strokes) const {
  shader::ViewPush push = shot.push;
  push.style.x = 1;
  push.style.y = 1;
  shot.on.draw(shot.with.stroke, {canvas.overlay_.ref()}, push, {.depth_test = false}, corners_of(strokes.count),
               corners_of(strokes.first));
}

}  // namespace palpa::viewer
