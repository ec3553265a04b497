// The common part of tests of real windows, on a private X server; skipped if there is no Xvfb.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "cli/support/process.hpp"
#include "support/begins.hpp"
#include "support/shared_data.hpp"
#include "viewer/render/drawing_test.hpp"
#include "x_display.hpp"

namespace palpa::test {

class ScreenTest : public DrawingTest {
 protected:
  void SetUp() override {
    DrawingTest::SetUp();
    if (IsSkipped()) return;
    server_.emplace();
    if (server_->name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  }
  /// For a program on that server. `config`: the folder with its settings, or "" for a new one. `scale`: what it
  /// enlarges everything by.
  Environment on_screen(const std::string& config = "", const std::string& scale = "1") const {
    return {{"DISPLAY", server_->name()},
            {"WAYLAND_DISPLAY", ""},
            {"XDG_CONFIG_HOME", config.empty() ? scratch_folder("settings-on-screen").string() : config},
            {"GDK_SCALE", scale},
            where_assets_are()};
  }
  /// Looking at a picture takes a while, so it looks now and then.
  static bool comes_to(const std::function<bool()>& condition) {
    return begins(condition, std::chrono::milliseconds(20));
  }

  std::optional<XServer> server_;
};

}  // namespace palpa::test
