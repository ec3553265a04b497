#include "viewer/panels/ui.hpp"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "viewer/panels/file_font.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

constexpr std::pair<ImGuiKey, Key> keys[] = {{ImGuiKey_Tab, Key::tab},
                                             {ImGuiKey_LeftArrow, Key::left},
                                             {ImGuiKey_RightArrow, Key::right},
                                             {ImGuiKey_UpArrow, Key::up},
                                             {ImGuiKey_DownArrow, Key::down},
                                             {ImGuiKey_PageUp, Key::page_up},
                                             {ImGuiKey_PageDown, Key::page_down},
                                             {ImGuiKey_Home, Key::home},
                                             {ImGuiKey_End, Key::end},
                                             {ImGuiKey_Delete, Key::del},
                                             {ImGuiKey_Backspace, Key::backspace},
                                             {ImGuiKey_Space, Key::space},
                                             {ImGuiKey_Enter, Key::enter},
                                             {ImGuiKey_Escape, Key::escape},
                                             {ImGuiKey_A, key_of('a')},
                                             {ImGuiKey_C, key_of('c')},
                                             {ImGuiKey_V, key_of('v')},
                                             {ImGuiKey_X, key_of('x')},
                                             {ImGuiKey_Y, key_of('y')},
                                             {ImGuiKey_Z, key_of('z')}};

int button_of(Button button) {
  return button == Button::left ? 0 : button == Button::right ? 1 : 2;
}

void set_style(double ratio, bool dark) {
  ImGuiStyle style;
  dark ? ImGui::StyleColorsDark(&style) : ImGui::StyleColorsLight(&style);
  style.WindowRounding = style.FrameRounding = style.GrabRounding = style.PopupRounding = 4;
  style.WindowBorderSize = style.FrameBorderSize = 1;
  style.FramePadding = {6, 2};
  style.ItemSpacing = {7, 4};
  style.WindowPadding = {9, 7};
  style.ScrollbarSize = 12;
  style.Colors[ImGuiCol_WindowBg].w = 1;
  // The strokes are thin, so ImGui's grey is too faint.
  style.Colors[ImGuiCol_TextDisabled] = dark ? ImVec4{0.64f, 0.65f, 0.68f, 1} : ImVec4{0.40f, 0.40f, 0.42f, 1};
  style.Colors[ImGuiCol_FrameBg] = dark ? ImVec4{0.22f, 0.24f, 0.28f, 1} : ImVec4{1, 1, 1, 1};
  style.Colors[ImGuiCol_FrameBgHovered] = dark ? ImVec4{0.27f, 0.31f, 0.38f, 1} : ImVec4{0.87f, 0.93f, 1, 1};
  style.Colors[ImGuiCol_Border] = dark ? ImVec4{0.46f, 0.49f, 0.54f, 1} : ImVec4{0.50f, 0.53f, 0.57f, 1};
  style.Colors[ImGuiCol_CheckMark] = dark ? ImVec4{0.45f, 0.72f, 1, 1} : ImVec4{0.05f, 0.33f, 0.68f, 1};
  style.Colors[ImGuiCol_SliderGrab] = dark ? ImVec4{0.36f, 0.56f, 0.80f, 1} : ImVec4{0.55f, 0.72f, 0.92f, 1};
  style.ScaleAllSizes(static_cast<float>(ratio));
  ImGui::GetStyle() = style;
}

}  // namespace

struct Ui::State {
  ImGuiContext* context = nullptr;
  Glyphs glyphs;
  std::string ttf;  ///< a font's bytes; empty: palpa's own strokes
  Sheet sheet;
  bool dark = false;
  double ratio = 0;
  std::deque<WindowEvent> waiting;
  std::array<bool, 128> down{};  ///< keys, after all waiting events
  std::optional<bool> typing;    ///< whether text is being typed, after all waiting events
  int settle = 3;                ///< pictures until sizes that depend on each other are final
  std::function<void(const std::string&)> copy;
  std::function<std::string()> paste;
  std::string pasted;
};

Ui::Ui(bool dark, std::function<void(const std::string&)> copy, std::function<std::string()> paste)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.context = ImGui::CreateContext();
  s.dark = dark;
  s.copy = std::move(copy);
  s.paste = std::move(paste);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  io.ConfigInputTextCursorBlink = false;  // an idle window need not be drawn
  for (const auto& [theirs, ours] : keys)
    io.KeyMap[theirs] = static_cast<int>(ours);
  io.ClipboardUserData = &s;
  if (s.copy) {
    io.SetClipboardTextFn = [](void* user, const char* text) { static_cast<State*>(user)->copy(text); };
  }
  if (s.paste) {
    io.GetClipboardTextFn = [](void* user) {
      State& state = *static_cast<State*>(user);
      state.pasted = state.paste();
      return state.pasted.c_str();
    };
  }
}

Ui::~Ui() {
  ImGui::DestroyContext(state_->context);
}

void Ui::set_dark(bool dark) {
  if (std::exchange(state_->dark, dark) != dark && state_->ratio > 0) set_style(state_->ratio, dark);
}

void Ui::use_font(std::string ttf) {
  state_->ttf = std::move(ttf);
  state_->ratio = 0;
}

bool Ui::take(const WindowEvent& event, bool on_text) {
  State& s = *state_;
  const ImGuiIO& io = ImGui::GetIO();
  s.settle = 2;
  // Each change of a key takes a picture, and Dear ImGui itself repeats keys that are held down.
  const bool key = event.kind == WindowEvent::Kind::key;
  if (!key || std::exchange(s.down[static_cast<unsigned char>(event.key) % s.down.size()], event.down) != event.down)
    s.waiting.push_back(event);
  switch (event.kind) {
    case WindowEvent::Kind::press:
      s.typing = on_text;
      return io.WantCaptureMouse;
    case WindowEvent::Kind::release:
    case WindowEvent::Kind::move:
    case WindowEvent::Kind::scroll:
      return io.WantCaptureMouse;
    case WindowEvent::Kind::key:
      if (s.typing.value_or(io.WantTextInput)) {
        if (event.down && (event.key == Key::enter || event.key == Key::escape)) s.typing = false;
        return true;
      }
      // Whatever is held, the keys that end everything are not the panels'.
      return io.WantCaptureKeyboard && event.key != Key::escape && event.key != key_of('o') && ImGui::IsAnyItemActive();
    case WindowEvent::Kind::text:
      return true;
    case WindowEvent::Kind::drop:
    case WindowEvent::Kind::damage:
      break;
  }
  return false;
}

void Ui::forget() {
  ImGuiIO& io = ImGui::GetIO();
  state_->waiting.clear();
  std::ranges::fill(io.MouseDown, false);
  std::ranges::fill(io.KeysDown, false);
  ImGui::ClearActiveID();
}

bool Ui::has_list() const {
  return state_->context->OpenPopupStack.Size > 0;
}

bool Ui::close_list() {
  if (!has_list()) return false;
  ImGui::ClosePopupToLevel(state_->context->OpenPopupStack.Size - 1, true);
  ImGui::ClearActiveID();
  state_->settle = 2;
  return true;
}

bool Ui::let_go() {
  if (!ImGui::IsAnyItemActive() || ImGui::GetIO().WantTextInput) return false;
  ImGui::ClearActiveID();
  state_->settle = 2;
  return true;
}

void Ui::begin(double width, double height, double ratio, double seconds) {
  State& s = *state_;
  ImGuiIO& io = ImGui::GetIO();
  if (ratio != s.ratio) {
    s.ratio = ratio;
    std::optional<Glyphs> glyphs = s.ttf.empty() ? std::nullopt : make_file_font(*io.Fonts, s.ttf, ratio);
    s.glyphs = glyphs ? std::move(*glyphs) : make_stroke_font(*io.Fonts, ratio);
    set_style(ratio, s.dark);
  }
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 1.0));
  io.MouseWheel = 0;
  if (s.waiting.empty()) s.typing.reset();  // from now on, ImGui itself knows
  // A button that is pressed and released between two pictures is still a click: one change per picture.
  bool changed = false;
  while (!s.waiting.empty() && !changed) {
    const WindowEvent& event = s.waiting.front();
    switch (event.kind) {
      case WindowEvent::Kind::press:
      case WindowEvent::Kind::release:
        io.MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
        io.MouseDown[button_of(event.button)] = event.kind == WindowEvent::Kind::press;
        changed = true;
        break;
      case WindowEvent::Kind::move:
        io.MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
        break;
      case WindowEvent::Kind::scroll:
        io.MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
        io.MouseWheel += static_cast<float>(event.steps);
        break;
      case WindowEvent::Kind::key:
        io.KeyCtrl = event.ctrl;
        io.KeyShift = event.shift;
        io.KeysDown[static_cast<unsigned char>(event.key)] = event.down;
        changed = true;
        break;
      case WindowEvent::Kind::text:
        io.AddInputCharactersUTF8(event.text.c_str());
        break;
      case WindowEvent::Kind::drop:
      case WindowEvent::Kind::damage:
        break;
    }
    s.waiting.pop_front();
  }
  ImGui::NewFrame();
}

const Sheet& Ui::end() {
  State& s = *state_;
  ImGui::Render();
  if (s.settle > 0) --s.settle;
  const ImDrawData& data = *ImGui::GetDrawData();
  const ImVec2 white = ImGui::GetIO().Fonts->TexUvWhitePixel;
  const auto atlas_width = static_cast<float>(s.glyphs.width), atlas_height = static_cast<float>(s.glyphs.height);
  s.sheet.corners.clear();
  s.sheet.runs.clear();
  s.sheet.glyphs = &s.glyphs;
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const float left = std::max(std::floor(command.ClipRect.x), 0.0f);
      const float top = std::max(std::floor(command.ClipRect.y), 0.0f);
      const float right = std::min(std::ceil(command.ClipRect.z), data.DisplaySize.x);
      const float bottom = std::min(std::ceil(command.ClipRect.w), data.DisplaySize.y);
      if (command.UserCallback != nullptr || right <= left || bottom <= top) continue;
      SheetRun run{static_cast<std::int32_t>(left),
                   static_cast<std::int32_t>(top),
                   static_cast<std::uint32_t>(right - left),
                   static_cast<std::uint32_t>(bottom - top),
                   static_cast<std::uint32_t>(s.sheet.corners.size()),
                   command.ElemCount};
      for (unsigned int k = 0; k < command.ElemCount; ++k) {
        const ImDrawVert& v = list.VtxBuffer[static_cast<int>(list.IdxBuffer[static_cast<int>(command.IdxOffset + k)] +
                                                              command.VtxOffset)];
        const bool plain = v.uv.x == white.x && v.uv.y == white.y;
        const ImVec4 c = ImGui::ColorConvertU32ToFloat4(v.col);
        s.sheet.corners.push_back(
            {{v.pos.x, v.pos.y, plain ? -1.0f : v.uv.x * atlas_width, plain ? -1.0f : v.uv.y * atlas_height},
             {c.x, c.y, c.z, c.w}});
      }
      s.sheet.runs.push_back(run);
    }
  }
  return s.sheet;
}

bool Ui::restless() const {
  return !state_->waiting.empty() || state_->settle > 0;
}

}  // namespace palpa::viewer
