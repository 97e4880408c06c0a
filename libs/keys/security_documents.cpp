// SPDX-License-Identifier: Apache-2.0
#include "keys/security_documents.h"

#include <fmt/format.h>

#include "transport/network.h"

namespace slew::keys {
namespace {

using transport::TopicSet;
using wire::Topic;

std::string domains() {
  return fmt::format("<domains><id_range><min>0</min><max>{}</max></id_range></domains>", transport::kMaxDomain);
}

std::string rule(const char* kind, const TopicSet& topics, const std::string& session) {
  if (topics.is_empty()) return "";
  std::string text = fmt::format("    <{}><topics>", kind);
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<Topic>(i);
    if (topics.contains(topic)) text += fmt::format("<topic>{}</topic>", transport::traits(topic).name);
  }
  return text +
         fmt::format("</topics><partitions><partition>slewring/{}</partition></partitions></{}>\n", session, kind);
}

}  // namespace

std::string governance_xml() {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
 <domain_access_rules><domain_rule>
  {}
  <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
  <enable_join_access_control>true</enable_join_access_control>
  <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
  <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
  <rtps_protection_kind>NONE</rtps_protection_kind>
  <topic_access_rules><topic_rule>
   <topic_expression>*</topic_expression>
   <enable_discovery_protection>true</enable_discovery_protection>
   <enable_liveliness_protection>true</enable_liveliness_protection>
   <enable_read_access_control>true</enable_read_access_control>
   <enable_write_access_control>true</enable_write_access_control>
   <metadata_protection_kind>SIGN_WITH_ORIGIN_AUTHENTICATION</metadata_protection_kind>
   <data_protection_kind>ENCRYPT</data_protection_kind>
  </topic_rule></topic_access_rules>
 </domain_rule></domain_access_rules>
</dds>
)",
                     domains());
}

std::string permissions_xml(const Grant& grant) {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
 <permissions><grant name="{}">
  <subject_name>{}</subject_name>
  <validity><not_before>{}</not_before><not_after>{}</not_after></validity>
  <allow_rule>
    {}
{}{}  </allow_rule>
  <default>DENY</default>
 </grant></permissions>
</dds>
)",
                     grant.name, grant.subject, grant.not_before, grant.not_after, domains(),
                     rule("publish", grant.writes, grant.session), rule("subscribe", grant.reads, grant.session));
}

}  // namespace slew::keys
