#include "viewer/sound/heat.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "base/activity.hpp"
#include "session/threads.hpp"
#include "setup/body.hpp"

namespace palpa::viewer {
namespace {

/// The pose that puts the mesh upright with its lowest vertex at `tip`.
Transform upright(const geometry::Mesh& mesh, const Vec3& tip) {
  const auto lowest = std::ranges::min_element(mesh.positions, {}, [](const Vec3& p) { return p.y; });
  return glm::translate(Transform(1.0), lowest == mesh.positions.end() ? tip : tip - *lowest);
}

bool has_place(const Sounding& now) {
  return now.plan != nullptr && now.layout && (now.T_world_finger || now.tip);
}

Transform place_of(const geometry::Mesh& mesh, const Sounding& now) {
  return now.T_world_finger ? *now.T_world_finger : upright(mesh, *now.tip);
}

bool near(const Transform& a, const Transform& b) {
  constexpr double finger_m = 50e-3;  // a turn moves the finger's far end
  for (int i = 0; i < 3; ++i) {
    if (glm::distance(Vec3(a[i]), Vec3(b[i])) * finger_m > alike_m) return false;
  }
  return glm::distance(Vec3(a[3]), Vec3(b[3])) <= alike_m;
}

/// The progress of the equations.
std::string progress() {
  const std::optional<Doing> now = doing();
  return now && now->total > 0 ? fmt::format(", {} %", 100 * now->done / now->total) : "";
}

}  // namespace

session::SkinQuestion skin_question(const std::string& file, const geometry::Mesh& mesh, const Sounding& now) {
  return {.name = file,
          .finger = mesh,
          .T_world_finger = place_of(mesh, now),
          .plan = *now.plan,
          .layout = *now.layout,
          .drive = now.drive,
          .air = now.air};
}

void show_answer(Picture& picture, const session::SkinQuestion& question, const session::SkinAnswer& answer) {
  geometry::Mesh mesh = question.finger;
  for (Vec3& p : mesh.positions)
    p = transform_point(question.T_world_finger, p);
  show_heat(picture, std::filesystem::path(question.name).stem().string(), std::move(mesh), answer.vertices);
}

Heat::Heat(std::string file, const acoustics::Air& air)
    : file_(std::move(file)), loading_(std::async(std::launch::async, [file = file_, air] {
        session::give_way();
        return setup::load_body(file, air, false);
      })) {}

bool Heat::is_of(const Sounding& now) const {
  return asked_ && near(asked_->T_world_finger, place_of(*mesh_, now)) &&
         alike(asked_->plan.schedule, now.plan->schedule);
}

Change Heat::tell(Picture& picture, Standing standing) {
  stale_ = standing == Standing::stale;
  return {.marks = mark(picture, Layer::heat, "pressure on the skin", standing, stale_ ? progress() : "")};
}

Change Heat::look(const Sounding& now, Picture& picture) {
  if (loading_.valid()) {
    if (loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return tell(picture, Standing::stale);
    try {
      mesh_ = loading_.get();
    } catch (const std::exception& error) {
      fault_ = error.what();
    }
  }
  if (!mesh_) return tell(picture, Standing::failed);
  if (!has_place(now)) {  // nothing touches
    Change change;
    change.skin = picture.skin.has_value();
    picture.skin.reset();
    change.marks = hide_bar(picture, Layer::heat);
    asked_.reset();
    stale_ = false;
    return change;
  }
  Change change;
  const bool computing = preview_.stale();  // read first: answers from now on are for the next look()
  const std::shared_ptr<const session::SkinAnswer> newest = preview_.newest();
  if (asked_ && newest->number > shown_ && !computing) {
    shown_ = newest->number;
    fault_ = newest->fault;
    if (fault_.empty()) {
      show_answer(picture, *asked_, *newest);
      change = {.skin = true, .marks = true};
    }
  }
  const bool same = is_of(now);
  if (!same && !computing) {
    asked_ = skin_question(file_, *mesh_, now);
    preview_.ask(*asked_);
    fault_.clear();
  }
  const bool stale = !same || computing;
  change |= tell(picture, !fault_.empty() ? Standing::failed : stale ? Standing::stale : Standing::fresh);
  return change;
}

void Heat::forget() {
  asked_.reset();
  shown_ = preview_.newest()->number;
}

}  // namespace palpa::viewer
