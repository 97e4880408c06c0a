// SPDX-License-Identifier: Apache-2.0
// Texts for the program on the other side of a layout: a C header and a note for Simulink's blocks.
#pragma once

#include <string>

#include "devices/byte_layout.h"

namespace slew::devices {

// C11 or C++11: a packed struct of the layout's name whose size and offsets are asserted, masks for divided integers.
// The numbers have the byte order of the packet; a comment gives what to do where that is not the host's.
[[nodiscard]] std::string c_header(const ByteLayout& layout);

// Markdown: the parameters of UDP Receive with Byte Unpack, and of Byte Pack with UDP Send.
[[nodiscard]] std::string simulink_note(const ByteLayout& layout);

}  // namespace slew::devices
