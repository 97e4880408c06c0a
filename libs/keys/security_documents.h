// SPDX-License-Identifier: Apache-2.0
// The documents of DDS Security 1.1 that a key store signs: what a domain protects, and what a holder of keys may do.
#pragma once

#include <string>

#include "transport/topics.h"

namespace slew::keys {

// Only participants with a certificate of the store take part; discovery and data are encrypted (AES-GCM). Every
// submessage of readers and writers is signed for each of its receivers (AES-GMAC): without that, recorded data could
// be replayed under other sequence numbers, and the counting messages (HEARTBEAT, GAP, ACKNACK) forged. Whole packets
// are not signed (rtps_protection_kind): with that Cyclone 0.10.2 cannot repair all losses while keys are exchanged.
[[nodiscard]] std::string governance_xml();

struct Grant {
  std::string name;     // name of the identity
  std::string subject;  // subject of its certificate, RFC 2253
  std::string session;  // name of the sessions it may take part in, with * and ?
  transport::TopicSet writes, reads;
  std::string not_before, not_after;  // 2026-11-23T00:00:00, UTC
};

// Denies all topics and sessions that are not named.
[[nodiscard]] std::string permissions_xml(const Grant& grant);

}  // namespace slew::keys
