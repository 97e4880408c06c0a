// Finds everything in a damaged recording that proves itself, also behind a damage.
//
// Chunks and attachments prove themselves by their checksum. The other records are proved by the Marks around them:
// what the one in front says, continued over the records, is what the one behind says. So one Mark is enough to go on
// from behind a damage, and the search for it, or for a whole chunk, looks at every byte. Index and summary at the
// end of the file are never looked at.
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
  std::uint64_t length = 0;  // with opcode and length
};

struct LostBytes {
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  std::string text;  // what is wrong there
};

struct Salvage {
  std::vector<ProvedRecord> records;  // header, metadata, attachments, schemas, channels, chunks; in the file's order
  std::vector<LostBytes> lost;        // ascending, in front of Data End
  bool is_damaged = false;            // in front of Data End; also where nothing is lost by it
  bool has_data_end = false;          // nothing was cut off
};

// Errors: storage. A damaged file is not an error.
[[nodiscard]] Status salvage_file(const InputFile& file, Salvage& salvage);

}  // namespace slew::recording
