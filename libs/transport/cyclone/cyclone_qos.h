// SPDX-License-Identifier: Apache-2.0
// Qualities of service of Cyclone, deleted when they are no longer held.
#pragma once

#include <dds/dds.h>

#include <memory>

namespace slew::transport {

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

}  // namespace slew::transport
