// SPDX-License-Identifier: Apache-2.0
// Command-line options of a device.
#pragma once

#include "device_node/device_run.h"
#include "options/options.h"

namespace slew::device_node {

// --session and the network, --devices, --assets, --session-timeout, --insecure-devices.
void add_device_options(options::Command& app, DeviceOptions& options);

}  // namespace slew::device_node
