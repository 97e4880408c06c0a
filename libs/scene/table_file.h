// SPDX-License-Identifier: Apache-2.0
// CSV files of tables: their notation in a scene, and opening them.
//
//   force_table: drive.csv
//   force_table: {file: log.csv, columns: [time, F1]}
//
// A table of more than kMaxPointsInText points is not in the scene's expanded text, which every node and recording
// holds. It stays in its file, an asset of the session; the text has its name, columns and SHA-256:
//
//   force_table: {file: log.csv, columns: [time, F1], sha256: 9f86d0...}
//
// Read with the folder of the files, that text accepts only this content; without a folder the table stays empty.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scene/field_reader.h"
#include "scene/scene.h"
#include "scene/source.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// The file that a value names; nothing after a reported problem. path: of the value in messages.
// ending: of its name.
[[nodiscard]] std::optional<TableFile> read_table_reference(const Node& node, const std::string& path,
                                                            const ReadContext& context,
                                                            std::string_view ending = ".csv");

// The columns of `columns: [NAME, ...]`; nothing after a reported problem.
[[nodiscard]] std::optional<std::vector<std::string>> read_column_names(const Node& node, const std::string& path,
                                                                        Report& report);

struct TableText {
  std::optional<SourceText> text;  // nothing after a reported problem, or without a folder
  std::optional<std::string> log;  // the bytes of an LCM event log (.lcm) in the place of a text
  int source = 0;                  // for marks
  bool is_file = false;            // problems belong to a file
};

// Reads the file and fills size, SHA-256 and place of the table.
[[nodiscard]] TableText open_table(TableFile& table, const Mark& mark, const ReadContext& context);

// Adds the files of the scene's long tables, which every node needs, to its assets. Only io needs those of a script.
void add_table_assets(Scene& scene);

// The reference as YAML.
[[nodiscard]] std::string reference_text(const TableFile& table);

}  // namespace slew::scene
