// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/shared_fields.h"

namespace slew::hydraulics {

void check_distinct(const std::string& path, const std::string& first, const std::string& second, Problems& errors) {
  if (first != second || first.empty()) return;
  errors.push_back({path, "it is connected to '" + first + "' as the port before it", "two volumes", ""});
}

}  // namespace slew::hydraulics
