// SPDX-License-Identifier: Apache-2.0
// Reads a recording from its first byte on and finds the longest prefix that can be trusted.
//
// Checks structure, checksums of chunks and attachments, the Marks between them, Data End and summary. The scan stops
// at the first missing or wrong byte. It keeps proved records: chunks and attachments by their own checksum, the other
// records by the Mark behind them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/status.h"
#include "recording/summary.h"

namespace slew::recording {

struct FileScan {
  FileIndex index;               // index of the prefix, with statistics; without message index offsets
  std::optional<Damage> damage;  // none: the file is complete and every byte is as written
  bool has_data_end = false;     // the messages are complete, even if the index behind them is not
};

// Errors: storage. A damaged file is not an error.
[[nodiscard]] Status scan_file(const InputFile& file, FileScan& scan);

}  // namespace slew::recording
