// SPDX-License-Identifier: Apache-2.0
// Names in any script as ASCII letters, so that they stay recognisable in a scene.
//
// Latin letters lose their marks (ä, ö, ü become ae, oe, ue), Greek, Cyrillic, kana and Hangul are romanised letter by
// letter, every other character becomes u and its number in hexadecimal ("u81C2"). Not covered: tones, stress, and the
// reading of Chinese characters.
#pragma once

#include <string>
#include <string_view>

namespace slew::urdf {

// utf8: bytes that are no UTF-8 become _. ASCII characters stay as they are.
[[nodiscard]] std::string in_ascii(std::string_view utf8);

}  // namespace slew::urdf
