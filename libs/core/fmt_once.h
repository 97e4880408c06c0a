// SPDX-License-Identifier: Apache-2.0
// The function of fmt that interprets a format text is in its library. Without this declaration every unit that calls
// format_to compiles it once more, which takes a quarter of the time of the unit. clang gives it another linker name
// than g++, which compiled the library.
#pragma once

#include <fmt/format.h>

#ifndef __clang__
extern template void fmt::detail::vformat_to<char>(fmt::detail::buffer<char>&, fmt::basic_string_view<char>,
                                                   fmt::basic_format_args<fmt::buffer_context<char>>,
                                                   fmt::detail::locale_ref);
#endif
