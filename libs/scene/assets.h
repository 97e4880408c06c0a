// SPDX-License-Identifier: Apache-2.0
// Files that belong to a scene: size and SHA-256, so that a node on another machine detects a different copy.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scene/diagnostic.h"
#include "scene/expand.h"
#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

inline constexpr std::size_t kMaxAssets = 256;

// Names stay inside the scene's folder, so that they are valid on every machine. Links are not followed: a file that is
// to be opened is checked by LoadContext::refusal_of.
[[nodiscard]] bool is_inside_folder(const std::string& name);

[[nodiscard]] Sha256 sha256_of(std::string_view bytes);
// As 64 hexadecimal digits, and back; nothing if the text is invalid.
[[nodiscard]] std::string hex_text(const Sha256& sum);
[[nodiscard]] std::optional<Sha256> read_sha256(std::string_view text);

// Size and hash of a file in the load context's folder; empty with the reason in `fault`, phrased about the file.
[[nodiscard]] std::optional<Asset> measure_asset(const std::string& name, const LoadContext& load_context,
                                                 std::string& fault);

// Reads the section `assets: [file, ...]`; with a load context every file is measured.
void read_assets(const Node& section, const LoadContext& load_context, Scene& scene, Report& report);

}  // namespace slew::scene
