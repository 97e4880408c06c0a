// The documents of DDS Security 1.1 that a key store signs: what a domain protects, and what a holder of keys may do.
#pragma once

#include <string>

#include "transport/topics.h"

namespace slew::keys {

// Only participants with a certificate of the store take part; discovery and data are encrypted (AES-GCM), and every
// submessage of readers and writers is signed for each of those that it is for (AES-GMAC): without that, data that were
// overheard could be sent again under other sequence numbers, and what counts them (HEARTBEAT, GAP, ACKNACK) forged.
// Not whole packets (rtps_protection_kind): with that Cyclone 0.10.2 cannot repair all losses while keys are exchanged.
[[nodiscard]] std::string governance_xml();

struct Grant {
  std::string name;     // of the identity
  std::string subject;  // of its certificate, RFC 2253
  std::string session;  // name of the sessions it may take part in, with * and ?
  transport::TopicSet writes, reads;
  std::string not_before, not_after;  // 2026-11-23T00:00:00, UTC
};

// All that is not named is denied.
[[nodiscard]] std::string permissions_xml(const Grant& grant);

}  // namespace slew::keys
