// SPDX-License-Identifier: Apache-2.0
// The sample decoder: any bytes of any message are decoded or refused, and a decoded message is encoded to the same
// contents.
//
// The first byte is the topic, modulo kTopicNumbers so that kept inputs stay those of their topic when topics are
// added.
#include <string>

#include "tests/fuzz/bytes.h"
#include "transport/cdr/codec.h"

namespace {

using namespace slew;

constexpr std::size_t kTopicNumbers = 32;
static_assert(wire::kTopics <= kTopicNumbers);

template <typename Message>
void try_as(transport::Bytes bytes) {
  static Message message, again;
  static transport::ByteBuffer encoded, encoded_again;
  if (!transport::decode(bytes, message)) return;
  // texts may hold characters that our writer refuses, such as a NUL
  if (!transport::encode(message, encoded)) return;
  fuzz::require(transport::decode(encoded, again));
  fuzz::require(transport::encode(again, encoded_again));
  fuzz::require(encoded == encoded_again);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const transport::Bytes bytes{reinterpret_cast<const std::byte*>(data) + 1, size - 1};
  wire::Header header;
  static_cast<void>(transport::decode_header(bytes, header));
  switch (static_cast<wire::Topic>(data[0] % kTopicNumbers)) {
    case wire::Topic::session:
      try_as<wire::SessionDescription>(bytes);
      break;
    case wire::Topic::node_status:
      try_as<wire::NodeStatus>(bytes);
      break;
    case wire::Topic::tick:
      try_as<wire::Tick>(bytes);
      break;
    case wire::Topic::mechanism:
      try_as<wire::MechanismMessage>(bytes);
      break;
    case wire::Topic::actuators:
      try_as<wire::ActuatorMessage>(bytes);
      break;
    case wire::Topic::flexible:
      try_as<wire::FlexibleMessage>(bytes);
      break;
    case wire::Topic::elastic:
      try_as<wire::ElasticMessage>(bytes);
      break;
    case wire::Topic::poses:
      try_as<wire::PoseMessage>(bytes);
      break;
    case wire::Topic::sensors:
      try_as<wire::SensorMessage>(bytes);
      break;
    case wire::Topic::variable_directory:
      try_as<wire::VariableDirectory>(bytes);
      break;
    case wire::Topic::variables:
      try_as<wire::VariableBlock>(bytes);
      break;
    case wire::Topic::controller_input:
      try_as<wire::ControllerInput>(bytes);
      break;
    case wire::Topic::controller_lease:
      try_as<wire::ControllerLease>(bytes);
      break;
    case wire::Topic::control_request:
      try_as<wire::ControlRequest>(bytes);
      break;
    case wire::Topic::control_reply:
      try_as<wire::ControlReply>(bytes);
      break;
    case wire::Topic::health:
      try_as<wire::Health>(bytes);
      break;
    case wire::Topic::resend:
      try_as<wire::ResendRequest>(bytes);
      break;
    case wire::Topic::checkpoint:
    case wire::Topic::state:
      try_as<wire::StatePart>(bytes);
      break;
    case wire::Topic::count:
      break;  // a larger number is no topic
  }
  return 0;
}
