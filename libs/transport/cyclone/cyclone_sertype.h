// SPDX-License-Identifier: Apache-2.0
// A Cyclone type whose samples are our encoded bytes, passed on as they are.
//
// It carries the type information of the generated type, so that typed readers and writers of other programs match
// and read, while Cyclone neither serialises nor checks anything: codec.h does, once. Internal interface of Cyclone
// 0.10.2 (sertype and serdata operations); compile against Debian's headers only.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace slew::transport {

// Creates the topic with the type of `descriptor`; returns the topic or a negative error. `type` is then the type for
// make_sample(), alive as long as the topic. room: samples for which memory is reserved from the first one on.
[[nodiscard]] dds_entity_t create_raw_topic(dds_entity_t participant, const dds_topic_descriptor_t& descriptor,
                                            const char* name, std::size_t room, const ddsi_sertype*& type);

// A sample with a copy of the bytes (encapsulation header first) for dds_writecdr, which takes over the reference.
[[nodiscard]] ddsi_serdata* make_sample(const ddsi_sertype& type, std::span<const std::byte> bytes);

// The bytes of a sample of such a type.
[[nodiscard]] std::span<const std::byte> bytes_of(const ddsi_serdata& sample);

}  // namespace slew::transport
