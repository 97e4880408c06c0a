// SPDX-License-Identifier: Apache-2.0
#include "transport/cyclone/cyclone_sertype.h"

#include <dds/ddsi/ddsi_keyhash.h>
#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/ddsi_typewrap.h>
#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/heap.h>

#include <cstring>
#include <new>

#include "transport/sample_pool.h"

namespace slew::transport {
namespace {

struct RawType {
  ddsi_sertype common;  // first: Cyclone sees only this
  const dds_topic_descriptor_t* descriptor;
  SamplePool* samples;
};

struct RawSample {
  ddsi_serdata common;  // first
  std::uint32_t size;
  [[nodiscard]] std::byte* bytes() noexcept { return reinterpret_cast<std::byte*>(this + 1); }
  [[nodiscard]] const std::byte* bytes() const noexcept { return reinterpret_cast<const std::byte*>(this + 1); }
};

const RawSample& raw(const ddsi_serdata* sample) {
  return *reinterpret_cast<const RawSample*>(sample);
}
const RawType& raw(const ddsi_sertype* type) {
  return *reinterpret_cast<const RawType*>(type);
}

// --- samples

// Cyclone may read up to the next multiple of four
constexpr std::size_t kTail = 4;

RawSample* new_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) {
  auto* sample = new (raw(type).samples->take(sizeof(RawSample) + size + kTail)) RawSample{};
  ddsi_serdata_init(&sample->common, type, kind);
  sample->common.hash = type->serdata_basehash;
  sample->size = static_cast<std::uint32_t>(size);
  std::memset(sample->bytes() + size, 0, kTail);
  return sample;
}

void sample_free(ddsi_serdata* sample) {
  // The previous owner has read the sample before it released it. The reference count orders that; the thread sanitizer
  // does not see it where libddsc does the last subtraction.
  static_cast<void>(__atomic_load_n(&sample->refc.v, __ATOMIC_ACQUIRE));
  SamplePool::give_back(sample);
}

std::uint32_t sample_size(const ddsi_serdata* sample) {
  return raw(sample).size;
}

// no key: all samples are of one instance
bool sample_eqkey(const ddsi_serdata*, const ddsi_serdata*) {
  return true;
}

ddsi_serdata* sample_from_ser(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                              std::size_t size) {
  RawSample* sample = new_sample(type, kind, size);
  std::uint32_t filled = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= filled) continue;
    // fragments may overlap: copy what is new
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(sample->bytes() + filled, payload + (filled - fragment->min), fragment->maxp1 - filled);
    filled = fragment->maxp1;
  }
  return &sample->common;
}

ddsi_serdata* sample_from_ser_iov(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                                  const ddsrt_iovec_t* parts, std::size_t size) {
  RawSample* sample = new_sample(type, kind, size);
  std::size_t filled = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && filled < size; ++i) {
    const std::size_t n = parts[i].iov_len < size - filled ? parts[i].iov_len : size - filled;
    std::memcpy(sample->bytes() + filled, parts[i].iov_base, n);
    filled += n;
  }
  return &sample->common;
}

ddsi_serdata* sample_from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return &new_sample(type, SDK_KEY, 0)->common;
}

// unused: no writer passes C structs
ddsi_serdata* sample_from_sample(const ddsi_sertype*, ddsi_serdata_kind, const void*) {
  return nullptr;
}

void sample_to_ser(const ddsi_serdata* sample, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, raw(sample).bytes() + offset, size);
}

ddsi_serdata* sample_to_ser_ref(const ddsi_serdata* sample, std::size_t offset, std::size_t size, ddsrt_iovec_t* part) {
  part->iov_base = const_cast<std::byte*>(raw(sample).bytes() + offset);
  part->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(sample);
}

void sample_to_ser_unref(ddsi_serdata* sample, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(sample);
}

bool sample_to_sample(const ddsi_serdata*, void*, void**, void*) {
  return false;
}

ddsi_serdata* sample_to_untyped(const ddsi_serdata* sample) {
  RawSample* untyped = new_sample(sample->type, SDK_KEY, 0);
  untyped->common.type = nullptr;
  return &untyped->common;
}

bool sample_untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;
}

std::size_t sample_print(const ddsi_sertype*, const ddsi_serdata*, char* text, std::size_t size) {
  if (size > 0) text[0] = '\0';
  return 0;
}

void sample_get_keyhash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  *hash = {};
}

constexpr ddsi_serdata_ops kSampleOps = {.eqkey = sample_eqkey,
                                         .get_size = sample_size,
                                         .from_ser = sample_from_ser,
                                         .from_ser_iov = sample_from_ser_iov,
                                         .from_keyhash = sample_from_keyhash,
                                         .from_sample = sample_from_sample,
                                         .to_ser = sample_to_ser,
                                         .to_ser_ref = sample_to_ser_ref,
                                         .to_ser_unref = sample_to_ser_unref,
                                         .to_sample = sample_to_sample,
                                         .to_untyped = sample_to_untyped,
                                         .untyped_to_sample = sample_untyped_to_sample,
                                         .free = sample_free,
                                         .print = sample_print,
                                         .get_keyhash = sample_get_keyhash,
                                         .get_sample_size = nullptr,
                                         .from_iox_buffer = nullptr};

// --- types

void type_free(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  raw(type).samples->close();
  delete reinterpret_cast<RawType*>(type);
}

void type_zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void type_realloc_samples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void type_free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

bool type_equal(const ddsi_sertype* a, const ddsi_sertype* b) {
  return raw(a).descriptor == raw(b).descriptor;
}
std::uint32_t type_hash(const ddsi_sertype*) {
  return 0;
}  // types are equal by their name, hashed by Cyclone

ddsi_typeinfo_t* type_info(const ddsi_sertype* type) {
  const auto& serialised = raw(type).descriptor->type_information;
  const ddsi_sertype_cdr_data data{serialised.sz, const_cast<unsigned char*>(serialised.data)};
  return ddsi_typeinfo_deser(&data);
}

ddsi_typemap_t* type_map(const ddsi_sertype* type) {
  const auto& serialised = raw(type).descriptor->type_mapping;
  const ddsi_sertype_cdr_data data{serialised.sz, const_cast<unsigned char*>(serialised.data)};
  return ddsi_typemap_deser(&data);
}

ddsi_typeid_t* type_id(const ddsi_sertype* type, ddsi_typeid_kind_t kind) {
  ddsi_typeinfo_t* information = type_info(type);
  if (information == nullptr) return nullptr;
  ddsi_typeid_t* identifier = ddsi_typeinfo_typeid(information, kind);
  ddsi_typeinfo_fini(information);
  ddsrt_free(information);
  return identifier;
}

std::size_t type_serialized_size(const ddsi_sertype*, const void*) {
  return SIZE_MAX;
}
bool type_serialize_into(const ddsi_sertype*, const void*, void*, std::size_t) {
  return false;
}

constexpr ddsi_sertype_ops kTypeOps = {.version = ddsi_sertype_v0,
                                       .arg = nullptr,
                                       .free = type_free,
                                       .zero_samples = type_zero_samples,
                                       .realloc_samples = type_realloc_samples,
                                       .free_samples = type_free_samples,
                                       .equal = type_equal,
                                       .hash = type_hash,
                                       .type_id = type_id,
                                       .type_map = type_map,
                                       .type_info = type_info,
                                       .derive_sertype = nullptr,
                                       .get_serialized_size = type_serialized_size,
                                       .serialize_into = type_serialize_into};

}  // namespace

dds_entity_t create_raw_topic(dds_entity_t participant, const dds_topic_descriptor_t& descriptor, const char* name,
                              std::size_t room, const ddsi_sertype*& type) {
  auto* own = new RawType{};
  own->descriptor = &descriptor;
  own->samples = SamplePool::create(room);
  ddsi_sertype_init(&own->common, descriptor.m_typename, &kTypeOps, &kSampleOps, /*topickind_no_key=*/true);
  own->common.allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  ddsi_sertype* used = &own->common;
  const dds_entity_t topic = dds_create_topic_sertype(participant, name, &used, nullptr, nullptr, nullptr);
  if (topic < 0) {
    ddsi_sertype_unref(&own->common);
    return topic;
  }
  type = used;
  return topic;
}

ddsi_serdata* make_sample(const ddsi_sertype& type, std::span<const std::byte> bytes) {
  RawSample* sample = new_sample(&type, SDK_DATA, bytes.size());
  std::memcpy(sample->bytes(), bytes.data(), bytes.size());
  return &sample->common;
}

std::span<const std::byte> bytes_of(const ddsi_serdata& sample) {
  return {raw(&sample).bytes(), raw(&sample).size};
}

}  // namespace slew::transport
