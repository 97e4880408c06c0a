// SPDX-License-Identifier: Apache-2.0
#include "transport/cdr/codec.h"

#include <bit>
#include <cstring>
#include <type_traits>

#include "transport/cdr/codec_fields.h"
#include "transport/cdr/sample_state.h"

namespace slew::transport {
namespace {

using detail::fields;

static_assert(std::endian::native == std::endian::little, "bytes are copied as they are");

constexpr std::size_t kEncapsulation = 4;
constexpr std::size_t kGranule = 4;  // the whole is padded to a multiple of it

// bytes up to the next multiple of an element's size (1, 2, 4, 8), counted from the end of the encapsulation header
[[nodiscard]] constexpr std::size_t padding(std::size_t position, std::size_t size) noexcept {
  return (0 - position) & (size - 1);
}

// where an encoder's bytes go: first counted, then stored
class Count {
 public:
  void put(const void*, std::size_t n) noexcept { position_ += n; }
  void zero(std::size_t n) noexcept { position_ += n; }
  [[nodiscard]] std::size_t position() const noexcept { return position_; }

 private:
  std::size_t position_ = 0;
};

class Store {
 public:
  explicit Store(std::byte* to) noexcept : begin_(to), to_(to) {}
  void put(const void* from, std::size_t n) noexcept {
    std::memcpy(to_, from, n);
    to_ += n;
  }
  void zero(std::size_t n) noexcept {
    for (std::size_t i = 0; i < n; ++i) *to_++ = std::byte{0};
  }
  [[nodiscard]] std::size_t position() const noexcept { return static_cast<std::size_t>(to_ - begin_); }

 private:
  std::byte* begin_;
  std::byte* to_;
};

template <typename Sink>
class Encoder {
 public:
  template <typename T>
  using Of = const T;

  explicit Encoder(Sink sink) noexcept : sink_(sink) {}

  template <typename... T>
  void operator()(const T&... values) noexcept {
    (item(values), ...);
  }

  [[nodiscard]] bool is_within_caps() const noexcept { return is_within_caps_; }
  [[nodiscard]] Sink& sink() noexcept { return sink_; }

 private:
  template <typename T>
  void item(const T& value) noexcept {
    if constexpr (std::is_same_v<T, bool>) {
      item(static_cast<std::uint8_t>(value));
    } else if constexpr (std::is_enum_v<T>) {
      is_within_caps_ = is_within_caps_ && static_cast<std::uint32_t>(value) < detail::kEnumerators<T>;
      item(static_cast<std::uint32_t>(value));
    } else if constexpr (std::is_arithmetic_v<T>) {
      sink_.zero(padding(sink_.position(), sizeof value));
      sink_.put(&value, sizeof value);
    } else {
      fields(*this, value);
    }
  }

  template <std::size_t N>
  void item(const std::array<std::uint8_t, N>& octets) noexcept {
    sink_.put(octets.data(), N);
  }

  template <typename T, std::size_t N>
  void item(const StaticVector<T, N>& values) noexcept {
    item(static_cast<std::uint32_t>(values.size()));
    if (values.empty()) return;
    sink_.zero(padding(sink_.position(), sizeof(T)));
    sink_.put(values.data(), values.size() * sizeof(T));
  }

  void item(const detail::Text<const std::string>& text) noexcept {
    const std::string& value = text.value;
    is_within_caps_ = is_within_caps_ && value.size() <= text.cap && value.find('\0') == std::string::npos;
    item(static_cast<std::uint32_t>(value.size() + 1));
    sink_.put(value.c_str(), value.size() + 1);
  }

  template <typename F>
  void item(const detail::Appended<F>& appended) noexcept {
    item(appended.field);
  }

  template <typename N>
  void item(const detail::Bounded<const N>& number) noexcept {
    is_within_caps_ = is_within_caps_ && number.is_within();
    item(number.value);
  }

  template <typename T>
  void item(const detail::List<const std::vector<T>>& list) noexcept {
    is_within_caps_ = is_within_caps_ && list.values.size() <= list.cap;
    item(static_cast<std::uint32_t>(list.values.size()));
    for (const T& value : list.values) fields(*this, value);
  }

  Sink sink_;
  bool is_within_caps_ = true;
};

class Decoder {
 public:
  template <typename T>
  using Of = T;

  explicit Decoder(Bytes bytes) noexcept : begin_(bytes.data()), from_(begin_), end_(begin_ + bytes.size()) {}

  template <typename... T>
  void operator()(T&&... values) {
    (item(values), ...);
  }

  // all fields read, and nothing left but padding
  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] bool has_finished() const noexcept { return is_good_ && remaining() < kGranule; }

 private:
  [[nodiscard]] std::size_t remaining() const noexcept { return static_cast<std::size_t>(end_ - from_); }

  // the next `count` elements of `size` bytes, aligned; nullptr and nothing more after a failure
  [[nodiscard]] const std::byte* elements(std::size_t count, std::size_t size) noexcept {
    const std::size_t gap = padding(static_cast<std::size_t>(from_ - begin_), size);
    if (!is_good_ || remaining() < gap || (remaining() - gap) / size < count) {
      is_good_ = false;
      return nullptr;
    }
    const std::byte* at = from_ + gap;
    from_ = at + count * size;
    return at;
  }

  // a length that does not exceed its cap and cannot need more bytes than are left; 0 after a failure
  [[nodiscard]] std::size_t length(std::size_t cap) noexcept {
    std::uint32_t n = 0;
    item(n);
    if (n > cap || n > remaining()) is_good_ = false;
    return is_good_ ? n : 0;
  }

  template <typename T>
  void item(T& value) {
    if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
      using Wire = std::conditional_t<std::is_enum_v<T>, std::uint32_t, std::uint8_t>;
      Wire number = 0;
      item(number);
      if (number >= limit<T>()) {
        is_good_ = false;
        return;
      }
      value = static_cast<T>(number);
    } else if constexpr (std::is_arithmetic_v<T>) {
      if (const std::byte* at = elements(1, sizeof value)) std::memcpy(&value, at, sizeof value);
    } else {
      fields(*this, value);
    }
  }

  template <typename T>
  [[nodiscard]] static constexpr std::uint32_t limit() noexcept {
    if constexpr (std::is_enum_v<T>) {
      return detail::kEnumerators<T>;
    } else {
      return 2;
    }
  }

  template <std::size_t N>
  void item(std::array<std::uint8_t, N>& octets) noexcept {
    if (const std::byte* at = elements(N, 1)) std::memcpy(octets.data(), at, N);
  }

  template <typename T, std::size_t N>
  void item(StaticVector<T, N>& values) noexcept {
    const std::size_t n = length(N);
    values.clear();
    if (n == 0) return;
    if (const std::byte* at = elements(n, sizeof(T))) {
      values.resize(n);
      std::memcpy(values.data(), at, n * sizeof(T));
    }
  }

  void item(detail::Text<std::string>& text) {
    const std::size_t n = length(text.cap + 1);
    const std::byte* at = elements(n, 1);
    if (at == nullptr || n == 0 || std::memchr(at, 0, n) != at + n - 1) {
      is_good_ = false;
      return;
    }
    text.value.assign(reinterpret_cast<const char*>(at), n - 1);
  }

  template <typename N>
  void item(detail::Appended<N&>& number) {
    number.field = {};
    if (!has_finished()) item(number.field);
  }

  void item(detail::Appended<detail::Text<std::string>>& text) {
    text.field.value.clear();
    if (!has_finished()) item(text.field);
  }

  template <typename N>
  void item(detail::Bounded<N>& number) {
    item(number.value);
    if (is_good_ && !number.is_within()) is_good_ = false;
  }

  template <typename T>
  void item(detail::List<std::vector<T>>& list) {
    list.values.resize(length(list.cap));
    for (T& value : list.values) {
      if (!is_good_) return;
      fields(*this, value);
    }
  }

  const std::byte* begin_;
  const std::byte* from_;
  const std::byte* end_;
  bool is_good_ = true;
};

[[nodiscard]] bool is_little_endian_cdr(Bytes bytes) noexcept {
  return bytes.size() >= kEncapsulation && bytes[0] == std::byte{0} && bytes[1] == std::byte{1};
}

}  // namespace

bool decode_header(Bytes bytes, wire::Header& header) {
  if (!is_little_endian_cdr(bytes)) return false;
  Decoder decoder(bytes.subspan(kEncapsulation));
  fields(decoder, header);
  return decoder.is_good();
}

bool decode_sample_state(Bytes bytes, wire::Header& header, wire::SampleState& state) {
  if (!is_little_endian_cdr(bytes)) return false;
  Decoder decoder(bytes.subspan(kEncapsulation));
  fields(decoder, header);
  fields(decoder, state);
  return decoder.is_good();
}

template <Message M>
bool encode(const M& message, ByteBuffer& buffer) {
  Encoder<Count> count{Count{}};
  fields(count, message);
  if (!count.is_within_caps()) return false;
  const std::size_t size = count.sink().position();
  const std::size_t pad = padding(size, kGranule);
  buffer.resize(kEncapsulation + size + pad);
  std::byte* to = buffer.data();
  // representation CDR_LE and, in the options, the number of padding bytes
  to[0] = std::byte{0};
  to[1] = std::byte{1};
  to[2] = std::byte{0};
  to[3] = static_cast<std::byte>(pad);
  Encoder<Store> store{Store(to + kEncapsulation)};
  fields(store, message);
  store.sink().zero(pad);
  return true;
}

template <Message M>
bool decode(Bytes bytes, M& message) {
  if (!is_little_endian_cdr(bytes)) return false;
  Decoder decoder(bytes.subspan(kEncapsulation));
  fields(decoder, message);
  return decoder.has_finished();
}

template bool encode(const wire::SessionDescription&, ByteBuffer&);
template bool encode(const wire::NodeStatus&, ByteBuffer&);
template bool encode(const wire::Tick&, ByteBuffer&);
template bool encode(const wire::MechanismMessage&, ByteBuffer&);
template bool encode(const wire::ActuatorMessage&, ByteBuffer&);
template bool encode(const wire::FlexibleMessage&, ByteBuffer&);
template bool encode(const wire::ElasticMessage&, ByteBuffer&);
template bool encode(const wire::PoseMessage&, ByteBuffer&);
template bool encode(const wire::SensorMessage&, ByteBuffer&);
template bool encode(const wire::VariableDirectory&, ByteBuffer&);
template bool encode(const wire::VariableBlock&, ByteBuffer&);
template bool encode(const wire::ControllerInput&, ByteBuffer&);
template bool encode(const wire::ControllerLease&, ByteBuffer&);
template bool encode(const wire::ControlRequest&, ByteBuffer&);
template bool encode(const wire::ControlReply&, ByteBuffer&);
template bool encode(const wire::Health&, ByteBuffer&);
template bool encode(const wire::ResendRequest&, ByteBuffer&);
template bool encode(const wire::StatePart&, ByteBuffer&);

template bool decode(Bytes, wire::SessionDescription&);
template bool decode(Bytes, wire::NodeStatus&);
template bool decode(Bytes, wire::Tick&);
template bool decode(Bytes, wire::MechanismMessage&);
template bool decode(Bytes, wire::ActuatorMessage&);
template bool decode(Bytes, wire::FlexibleMessage&);
template bool decode(Bytes, wire::ElasticMessage&);
template bool decode(Bytes, wire::PoseMessage&);
template bool decode(Bytes, wire::SensorMessage&);
template bool decode(Bytes, wire::VariableDirectory&);
template bool decode(Bytes, wire::VariableBlock&);
template bool decode(Bytes, wire::ControllerInput&);
template bool decode(Bytes, wire::ControllerLease&);
template bool decode(Bytes, wire::ControlRequest&);
template bool decode(Bytes, wire::ControlReply&);
template bool decode(Bytes, wire::Health&);
template bool decode(Bytes, wire::ResendRequest&);
template bool decode(Bytes, wire::StatePart&);

}  // namespace slew::transport
