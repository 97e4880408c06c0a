// SPDX-License-Identifier: Apache-2.0
// Finds all proved records of a damaged recording, also after the damage.
//
// Chunks and attachments prove themselves by their checksum. The other records are proved by the Marks around them: the
// checksum of the Mark in front, continued over the records, equals that of the Mark behind. So one Mark suffices to
// continue after damage. The search for a Mark, or for a whole chunk, tests every byte. Index and summary at the end of
// the file are not used.
#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "recording/input_file.h"
#include "recording/records.h"

namespace slew::recording {

struct ProvedRecord {
  Opcode opcode = Opcode::invalid;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  // length with opcode and length field
};

struct LostBytes {
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  std::string text;  // problem at this place
};

struct Salvage {
  std::vector<ProvedRecord> records;  // header, metadata, attachments, schemas, channels, chunks; in the file's order
  std::vector<LostBytes> lost;        // ascending, in front of Data End
  bool is_damaged = false;            // damage in front of Data End, even without lost records
  bool has_data_end = false;          // true: the file was not cut
};

// Errors: storage. A damaged file is not an error.
[[nodiscard]] Status salvage_file(const InputFile& file, Salvage& salvage);

}  // namespace slew::recording
