#include "viewer/sound/heat.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/words.hpp"
#include "experiment/skin_rates.hpp"
#include "session/threads.hpp"
#include "setup/files/body.hpp"

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

/// Where the class is in session::SkinAnswer::rates.
std::size_t class_of(SkinColour colour) {
  return static_cast<std::size_t>(colour) - static_cast<std::size_t>(SkinColour::sa1);
}

/// While there is no value yet.
std::string name_of(SkinColour colour) {
  if (colour == SkinColour::pressure) return "pressure on the skin";
  return fmt::format("rates of {} on the skin", word_of(skin_colour_words, colour));
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

void show_answer(Picture& picture, const session::SkinQuestion& question, const session::SkinAnswer& answer,
                 SkinColour colour) {
  geometry::Mesh mesh = question.finger;
  for (Vec3& p : mesh.positions)
    p = transform_point(question.T_world_finger, p);
  const std::string name = std::filesystem::path(question.name).stem().string();
  if (colour == SkinColour::pressure) {
    show_heat(picture, name, std::move(mesh), answer.vertices, "mean radiation pressure on the skin, Pa");
    return;
  }
  std::vector<double> rates;
  rates.reserve(answer.rates.size());
  for (const std::array<double, 3>& at_vertex : answer.rates)
    rates.push_back(at_vertex[class_of(colour)]);
  show_heat(picture, name, std::move(mesh), rates,
            fmt::format("{}: mean rate of an afferent, spikes per second", word_of(skin_colour_words, colour)));
}

Heat::Heat(std::string file, const acoustics::Air& air)
    : file_(std::move(file)),
      loading_(std::async(std::launch::async,
                          [file = file_, air] {
                            session::give_way();
                            return setup::load_body(file, air, false);
                          })),
      preview_([rates = std::make_shared<experiment::SkinRates>()](
                   const session::SkinQuestion& question, acoustics::BodyCache& bodies,
                   const std::atomic<bool>* give_up) { return rates->answer(question, bodies, give_up); }) {}

bool Heat::is_of(const Sounding& now, SkinColour colour) const {
  if (!asked_) return false;
  // A fault of the rates says nothing about the pressure.
  const bool fits = colour != SkinColour::pressure ? asked_->afferents : !asked_->afferents || fault_.empty();
  return fits && near(asked_->T_world_finger, place_of(*mesh_, now)) &&
         alike(asked_->plan.schedule, now.plan->schedule);
}

Change Heat::tell(Picture& picture, Standing standing, SkinColour colour) {
  stale_ = standing == Standing::stale;
  return {.marks = mark(picture, Layer::heat, name_of(colour), standing, stale_ ? progress() : "")};
}

Change Heat::look(const Sounding& now, Picture& picture, SkinColour colour) {
  if (loading_.valid()) {
    if (loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      return tell(picture, Standing::stale, colour);
    try {
      mesh_ = loading_.get();
    } catch (const std::exception& error) {
      fault_ = error.what();
    }
  }
  if (!mesh_) return tell(picture, Standing::failed, colour);
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
  const bool answers = colour == SkinColour::pressure || (asked_ && asked_->afferents);
  const bool recoloured = colour != shown_colour_ && answers && newest->number == shown_ && newest->fault.empty();
  if (asked_ && !computing && (newest->number > shown_ || recoloured)) {
    shown_ = newest->number;
    fault_ = newest->fault;
    if (fault_.empty() && answers) {
      shown_colour_ = colour;
      show_answer(picture, *asked_, *newest, colour);
      change = {.skin = true, .marks = true};
    }
  }
  const bool same = is_of(now, colour);
  if (!same && !computing) {
    asked_ = skin_question(file_, *mesh_, now);
    asked_->afferents = colour != SkinColour::pressure;
    preview_.ask(*asked_);
    fault_.clear();
  }
  const bool stale = !same || computing;
  change |= tell(picture, !fault_.empty() ? Standing::failed : stale ? Standing::stale : Standing::fresh, colour);
  return change;
}

void Heat::forget() {
  asked_.reset();
  shown_ = preview_.newest()->number;
}

}  // namespace palpa::viewer
