// SPDX-License-Identifier: Apache-2.0
// The program device_node: one device of a scene as a process of its own.
#include <fmt/format.h>

#include <cstdio>

#include "core/printable.h"
#include "device_node/device_options.h"
#include "device_node/device_run.h"
#include "node/driver.h"
#include "program/node_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  options::Program program("device_node",
                           "A device of a Slewring session: it moves inputs, or shows variables and outputs. Takes the "
                           "scene from the session.");
  program.footer("Example:\n  device_node --session truck_crane --device Stick_Left");
  device_node::DeviceOptions options;
  program.option("--device", options.device, "name of the device in the scene").value_name("NAME").required();
  device_node::add_device_options(program, options);
  program.find("--session").required();
  program.flag("--supervised", options.is_supervised,
               "print signs of life, and the summary as JSON: for 'slewring run'");
  program.action([&] {
    node::install_signal_handlers();
    const auto report = [](const std::string& line) {
      fmt::print("{}\n", printable(line));
      std::fflush(stdout);
    };
    const Json summary = device_node::run_device(options, report);
    report(options.is_supervised ? std::string(device_node::kSummaryPrefix) + summary.dump()
                                 : device_node::summary_text(summary));
    return static_cast<ExitCode>(node::stop_requested.load());
  });
  return program::run_program(program, argc, argv);
}
