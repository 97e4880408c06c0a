// SPDX-License-Identifier: Apache-2.0
// The one function of the library of Fast DDS. It is built with the programs and lies beside them.
#pragma once

#include <memory>

#include "transport/network.h"

namespace slew::transport {

inline constexpr const char* kFastDdsLibrary = "libslewring_fastdds.so";
inline constexpr const char* kOpenFastDds = "slewring_open_fastdds";

// See open_transport(), whose result is in `status`: a function with a name of C returns no class.
using OpenFastDds = void(const Network& network, const Endpoint& endpoint, std::unique_ptr<Transport>& transport,
                         Status& status);

}  // namespace slew::transport
