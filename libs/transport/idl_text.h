// SPDX-License-Identifier: Apache-2.0
// The interface definition, idl/slewring.idl, as text: the schema of messages in recordings and for foreign clients.
#pragma once

#include <string_view>

namespace slew::transport {

[[nodiscard]] std::string_view idl_text() noexcept;

}  // namespace slew::transport
