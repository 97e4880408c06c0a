// Reads a recording from its first byte on and finds the longest prefix that can be trusted.
//
// Everything is checked: structure, checksums of chunks and attachments, the Marks between them, Data End, summary. The
// scan stops at the first byte that is missing or wrong. Kept is what is proved: chunks and attachments by their own
// checksum, the other records by the Mark behind them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/status.h"
#include "recording/summary.h"

namespace slew::recording {

struct FileScan {
  FileIndex index;               // of the prefix, with statistics; without message index offsets
  std::optional<Damage> damage;  // none: the file is complete and every byte of it is as it was written
  bool has_data_end = false;     // the messages are complete, whatever happened to the index behind them
};

// Errors: storage. A damaged file is not an error.
[[nodiscard]] Status scan_file(const InputFile& file, FileScan& scan);

}  // namespace slew::recording
