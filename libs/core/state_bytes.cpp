// SPDX-License-Identifier: Apache-2.0
#include "core/state_bytes.h"

#include <cstring>
#include <string>

#include "core/state_hash.h"

namespace slew {
namespace {

constexpr std::uint32_t kMagic = 0x53574c53;  // "SLWS"

struct Header {
  std::uint32_t magic = kMagic, layout = 0;
  std::uint64_t model = 0, length = 0, check = 0;
};
static_assert(sizeof(Header) == 32);

std::uint64_t check_of(std::span<const std::byte> bytes) noexcept {
  StateHash hash;
  hash.add_bytes(bytes.data(), bytes.size());
  return hash.digest();
}

}  // namespace

StateWriter::StateWriter(std::vector<std::byte>& bytes, StateFormat format) : bytes_(bytes), begin_(bytes.size()) {
  const Header header{.layout = format.layout, .model = format.model};
  append(&header, sizeof header);
}

void StateWriter::append(const void* data, std::size_t size) {
  const auto* const first = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), first, first + size);
}

void StateWriter::finish() noexcept {
  Header header;
  std::memcpy(&header, bytes_.data() + begin_, sizeof header);
  const std::span<const std::byte> content = std::span(bytes_).subspan(begin_ + sizeof header);
  header.length = content.size();
  header.check = check_of(content);
  std::memcpy(bytes_.data() + begin_, &header, sizeof header);
}

StateReader::StateReader(std::span<const std::byte> bytes, StateFormat format) noexcept
    : expected_layout_(format.layout) {
  fault_ = open(bytes, format);
}

StateReader::Fault StateReader::open(std::span<const std::byte> bytes, StateFormat format) noexcept {
  Header header;
  if (bytes.size() < sizeof header) return Fault::cut;
  std::memcpy(&header, bytes.data(), sizeof header);
  rest_ = bytes.subspan(sizeof header);
  layout_ = header.layout;
  if (header.magic != kMagic) return Fault::no_state;
  if (header.layout != format.layout) return Fault::layout;
  if (header.length > rest_.size()) return Fault::cut;
  if (header.length < rest_.size() || header.check != check_of(rest_)) return Fault::damaged;
  return header.model == format.model ? Fault::none : Fault::model;
}

void StateReader::take(void* target, std::size_t size) noexcept {
  if (!is_sound() || size == 0) return;
  if (size > rest_.size()) return note(Fault::cut);
  std::memcpy(target, rest_.data(), size);
  rest_ = rest_.subspan(size);
}

Status StateReader::finish(std::string_view whose) const {
  std::string what;
  switch (fault_) {
    case Fault::none:
      if (rest_.empty()) return Status::ok();
      what = "holds more than this scene's state";
      break;
    case Fault::cut:
      what = "is cut";
      break;
    case Fault::no_state:
      what = "is no saved state";
      break;
    case Fault::layout:
      what = "has layout " + std::to_string(layout_) + ", this build reads layout " + std::to_string(expected_layout_) +
             ": continue it with the build that saved it";
      break;
    case Fault::model:
      what = "is of another scene: continue it with the scene it was saved from";
      break;
    case Fault::damaged:
      what = "is damaged";
      break;
  }
  return Status::error(ExitCode::bad_input,
                       "the saved state of " + std::string(whose) + " " + what +
                           "; nothing of it was taken. Save it again, or start from the beginning");
}

}  // namespace slew
