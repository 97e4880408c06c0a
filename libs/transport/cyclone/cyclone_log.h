// SPDX-License-Identifier: Apache-2.0
// Cyclone's messages. Cyclone has one sink per process: the last one installed is in force; its destructor restores
// Cyclone's own.
#pragma once

#include "transport/middleware_log.h"

namespace slew::transport {

class CycloneLog : public MiddlewareLog {
 public:
  CycloneLog();
  ~CycloneLog();

  // Leaves out what Cyclone reports without a cause.
  void write(std::string_view line);
};

}  // namespace slew::transport
