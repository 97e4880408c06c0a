// Files that a scene names beside itself: every node must have the same ones.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/status.h"
#include "transport/wire.h"

namespace slew::node {

// Size and SHA-256 of a file in `directory`. Error bad_input: the file cannot be read, with the reason.
Status describe_asset(const std::filesystem::path& directory, const std::string& name, wire::Asset& asset);

// Every asset of the manifest is in `directory` with the same content. Error bad_input: names each that differs.
Status check_assets(const std::filesystem::path& directory, std::span<const wire::Asset> manifest);

}  // namespace slew::node
