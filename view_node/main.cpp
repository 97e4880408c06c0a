// SPDX-License-Identifier: Apache-2.0
// The program view_node: the window of a session or a recording, for a browser and for clients of the Foxglove
// protocol.
#include <fmt/format.h>

#include <cstdio>

#include "core/printable.h"
#include "node/driver.h"
#include "program/add_session_options.h"
#include "program/node_program.h"
#include "view_node/window.h"

int main(int argc, char** argv) {
  using namespace slew;
  options::Program program("view_node",
                           "The window of a Slewring session or recording: a page, and the Foxglove protocol.");
  program.footer("Example:\n  view_node --session truck_crane --port 0");
  view_node::WindowOptions options;
  program.option("recording", options.recording, "recording, or the folder of a run, in the place of a session")
      .value_name("REC");
  program::add_session_options(program, options.session, false);
  program.option("--session-timeout", options.session_timeout, "seconds to wait for the session")
      .between(0.1, 86400.0)
      .value_name("S")
      .show_default()
      .group("Session");
  view_node::add_window_options(program, options);
  program
      .option("--scene", options.scene,
              "file of the session's scene, which the page may edit and restart: of the command that started both")
      .value_name("SCENE")
      .group("Window");
  program.option("--set", options.set, "with --scene: a setting over it")
      .value_name("PATH=VALUE")
      .one_value_each()
      .group("Window");
  program.flag("--json", options.is_json, "print the addresses as JSON");
  program.action([&] {
    node::install_signal_handlers();
    return view_node::run_window(options, [](const std::string& line) {
      fmt::print("{}\n", printable(line));
      std::fflush(stdout);
    });
  });
  return program::run_program(program, argc, argv);
}
