// SPDX-License-Identifier: Apache-2.0
// Field tables of a described flexible body, for the parts of its file.
#pragma once

#include <span>
#include <string_view>

#include "core/field.h"
#include "flex/flexible_body.h"

namespace slew::flex {

// A shape of section; its fields bind to NamedSection.
struct SectionType {
  std::string_view name;  // value of the key `shape`
  SectionShape shape = SectionShape::given;
  std::string_view doc;
  std::span<const Field> fields;
};

[[nodiscard]] std::span<const Field> body_fields() noexcept;          // fields of FlexibleBodyDef, its single values
[[nodiscard]] std::span<const Field> material_fields() noexcept;      // fields of NamedMaterial
[[nodiscard]] std::span<const SectionType> section_types() noexcept;  // in the order of SectionShape
[[nodiscard]] std::span<const Field> stress_point_fields() noexcept;  // fields of StressPointDef
[[nodiscard]] std::span<const Field> line_fields() noexcept;          // fields of NodeLineDef
[[nodiscard]] const Field& node_field() noexcept;                     // position of a BeamNodeDef
[[nodiscard]] std::span<const Field> element_fields() noexcept;       // fields of ElementChainDef
[[nodiscard]] std::span<const Field> matrix_file_fields() noexcept;   // fields of MatrixFilesDef
[[nodiscard]] std::span<const Field> reduction_fields() noexcept;     // fields of BodyReductionDef

// Keys that describe a beam, without effect on imported matrices.
[[nodiscard]] std::span<const std::string_view> beam_keys() noexcept;

}  // namespace slew::flex
