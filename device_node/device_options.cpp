// SPDX-License-Identifier: Apache-2.0
#include "device_node/device_options.h"

#include "program/add_session_options.h"

namespace slew::device_node {

void add_device_options(options::Command& app, DeviceOptions& options) {
  program::add_session_options(app, options.session, false);
  app.option("--devices", options.file, "file with sections devices and outputs, in the place of those of the scene")
      .value_name("FILE");
  app.option("--assets", options.assets,
             "folder of the recorded events and frames that the scene names; those of --devices are beside its file")
      .value_name("DIR")
      .show_default();
  app.option("--session-timeout", options.session_timeout, "seconds to wait for the session")
      .between(0.1, 86400.0)
      .value_name("S")
      .show_default()
      .group("Session");
  app.flag("--insecure-devices", options.is_insecure,
           "receive and send UDP beyond this machine: any program there can read the values and move the machine")
      .group("Network");
}

}  // namespace slew::device_node
