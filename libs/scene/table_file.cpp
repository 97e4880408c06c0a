// SPDX-License-Identifier: Apache-2.0
#include "scene/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/input_file.h"
#include "core/suggestion.h"
#include "scene/assets.h"
#include "scene/canonical.h"
#include "scene/csv_cells.h"
#include "scene/expand.h"

namespace slew::scene {
namespace {

constexpr std::string_view kKeys[] = {"file", "columns", "sha256"};

bool read_content(const Node& node, const std::string& path, TableFile& table, Report& report) {
  const std::optional<Sha256> sum = node.kind == Node::Kind::scalar ? read_sha256(node.text) : std::nullopt;
  if (!sum) {
    report.add(node.mark, path + ".sha256", {"is " + describe(node), "64 hexadecimal digits", ""});
    return false;
  }
  table.sha256 = *sum;
  table.is_pinned = true;
  return true;
}

bool read_name(const Node& node, const std::string& path, std::string_view ending, TableFile& table, Report& report) {
  if (node.kind == Node::Kind::scalar && node.text.ends_with(ending)) {
    table.file = node.text;
    return true;
  }
  report.add(node.mark, path, {"is " + describe(node), fmt::format("the name of a {} file", ending), ""});
  return false;
}

}  // namespace

std::optional<std::vector<std::string>> read_column_names(const Node& node, const std::string& path, Report& report) {
  std::vector<std::string> names;
  const bool is_list = node.kind == Node::Kind::sequence && !node.items.empty();
  if (!is_list) report.add(node.mark, path, {"is " + describe(node), "a list of names of columns", ""});
  if (!is_list) return std::nullopt;
  for (const Node& item : node.items) {
    if (item.kind != Node::Kind::scalar || item.text.empty()) {
      report.add(item.mark, path, {"an entry is " + describe(item), "the name of a column", ""});
      return std::nullopt;
    }
    names.push_back(item.text);
  }
  return names;
}

std::optional<TableFile> read_table_reference(const Node& node, const std::string& path, const ReadContext& context,
                                              std::string_view ending) {
  TableFile table{.path = path, .file = {}, .columns = {}, .found = {}};
  if (node.kind == Node::Kind::scalar)
    return read_name(node, path, ending, table, context.report) ? std::optional(std::move(table)) : std::nullopt;
  const std::size_t problems = context.report.size();
  report_duplicates(node, path, context.report);
  for (const Node::Entry& entry : node.entries) {
    if (entry.key == "file") {
      (void)read_name(entry.value, path + ".file", ending, table, context.report);
    } else if (entry.key == "columns") {
      if (auto names = read_column_names(entry.value, path + ".columns", context.report))
        table.columns = std::move(*names);
    } else if (entry.key == "sha256") {
      (void)read_content(entry.value, path, table, context.report);
    } else {
      context.report.add(entry.mark, path + "." + entry.key,
                         {"unknown key", choice_list(kKeys), closest(entry.key, {std::begin(kKeys), std::end(kKeys)})});
    }
  }
  if (node.find("file") == nullptr)
    context.report.add(node.mark, path, {"the key 'file' is missing", "the name of a .csv file", ""});
  return context.report.size() == problems ? std::optional(std::move(table)) : std::nullopt;
}

TableText open_table(TableFile& table, const Mark& mark, const ReadContext& context) {
  TableText opened;
  const LoadContext* around = context.load_context;
  const bool has_folder = around != nullptr && (around->has_folder || around->has_assets);
  if (!has_folder) {
    // the text of a session, read without the need for tables
    if (!table.is_pinned)
      context.report.add(mark, table.path,
                         {"a scene without a folder cannot name a file", "the points themselves", ""});
    return opened;
  }
  if (auto refusal = around->refusal_of(table.file)) {
    context.report.add(mark, table.path, std::move(*refusal));
    return opened;
  }
  opened.is_file = true;
  table.found = around->has_folder ? around->path_of(table.file) : around->asset_path_of(table.file);
  const int source = context.report.add_source(table.found);
  opened.source = source;
  std::string bytes;
  if (auto fault = read_input(table.found, kMaxTableBytes, bytes)) {
    context.report.add({source, 0, 0}, "", {std::move(fault->what), std::move(fault->expected), ""});
    return opened;
  }
  const Sha256 sum = sha256_of(bytes);
  if (table.is_pinned && sum != table.sha256) {
    context.report.add(
        {source, 0, 0}, "",
        {"differs from the file that the scene was read with", "the file with SHA-256 " + hex_text(table.sha256), ""});
    return opened;
  }
  table.sha256 = sum;
  table.size = bytes.size();
  if (!around->is_confined) table.file = std::filesystem::path(table.file).filename().string();
  if (table.file.ends_with(".lcm")) {
    opened.log = std::move(bytes);
  } else {
    opened.text = check_source(std::move(bytes), source, context.report, kMaxTableBytes);
  }
  return opened;
}

void add_table_assets(Scene& scene) {
  for (const TableFile& table : scene.table_files) {
    const auto has_its_name = [&](const Asset& asset) { return asset.name == table.file; };
    if (table.found.empty() || std::any_of(scene.assets.begin(), scene.assets.end(), has_its_name)) continue;
    scene.assets.push_back({table.file, table.size, table.sha256});
  }
}

std::string reference_text(const TableFile& table) {
  std::string columns;
  for (const std::string& name : table.columns) columns += (columns.empty() ? "" : ", ") + yaml_text(name);
  if (!columns.empty()) columns = ", columns: [" + columns + "]";
  return fmt::format("{{file: {}{}, sha256: \"{}\"}}", yaml_text(table.file), columns, hex_text(table.sha256));
}

}  // namespace slew::scene
