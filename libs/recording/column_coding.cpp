// SPDX-License-Identifier: Apache-2.0
#include "recording/column_coding.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

namespace slew::recording {
namespace {

constexpr std::size_t kWord = sizeof(std::uint64_t);
constexpr std::size_t kFixedWords = 3;      // log time, publish time, sequence
constexpr std::size_t kEncapsulation = 4;   // bytes in front of the CDR
constexpr std::size_t kRoleAt = 20;         // payload byte of Header.role
constexpr std::size_t kKindAt = 44;         // payload byte of the first field behind the Header
constexpr std::size_t kMaxGroups = 0xffff;  // their numbers have 16 bits
constexpr std::size_t kColumnHeadBytes = 8 + 3;
constexpr int kMaxOrder = 3;
// decoded tables are larger than the records by the heads of groups and columns only
constexpr std::size_t kMaxTableFactor = 3;
constexpr std::size_t kSpareTableBytes = 64 * 1024;

constexpr std::size_t words_of_row(std::size_t payload_bytes) noexcept {
  return kFixedWords + (payload_bytes + kEncapsulation + kWord - 1) / kWord;
}

template <typename T>
T load(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

// small differences of either sign become small numbers
constexpr std::uint64_t folded(std::uint64_t difference) noexcept {
  return (difference << 1) ^ (0 - (difference >> 63));
}
constexpr std::uint64_t unfolded(std::uint64_t value) noexcept {
  return (value >> 1) ^ (0 - (value & 1));
}

// Expected next word from up to three former ones: order 1 holds the last, 2 goes on straight, 3 as a parabola.
struct Former {
  std::uint64_t last = 0, before = 0, third = 0;
  std::size_t count = 0;
  [[nodiscard]] std::uint64_t expected(int order) const noexcept {
    const int possible = static_cast<int>(std::min<std::size_t>(count, static_cast<std::size_t>(order)));
    if (possible <= 1) return last;
    return possible == 2 ? 2 * last - before : 3 * last - 3 * before + third;
  }
  void add(std::uint64_t word) noexcept {
    third = before;
    before = last;
    last = word;
    ++count;
  }
};

// The order with the fewest bits, and the most bits that one difference takes with it.
struct Best {
  int order = 1;
  int most_bits = 0;
};

Best best_order(const std::uint64_t* column, std::size_t rows, int shift) noexcept {
  std::array<std::uint64_t, kMaxOrder + 1> sum{};
  std::array<int, kMaxOrder + 1> most{};
  Former former;
  former.add(column[0] >> shift);
  for (std::size_t i = 1; i < rows; ++i) {
    const std::uint64_t word = column[i] >> shift;
    for (int order = 1; order <= kMaxOrder; ++order) {
      const int bits = static_cast<int>(std::bit_width(folded(word - former.expected(order))));
      sum[static_cast<std::size_t>(order)] += static_cast<std::uint64_t>(bits);
      most[static_cast<std::size_t>(order)] = std::max(most[static_cast<std::size_t>(order)], bits);
    }
    former.add(word);
  }
  const auto least = std::min_element(sum.begin() + 1, sum.end());
  const auto order = static_cast<std::size_t>(least - sum.begin());
  return {static_cast<int>(order), most[order]};
}

}  // namespace

void ColumnEncoder::FreeContext::operator()(ZSTD_CCtx_s* context) const noexcept {
  ZSTD_freeCCtx(context);
}

ColumnEncoder::ColumnEncoder(int level) : context_(ZSTD_createCCtx()) {
  if (context_) ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, level);
}

ColumnEncoder::~ColumnEncoder() = default;

// Messages come in a rhythm: the group that followed the last time is tried first.
std::size_t ColumnEncoder::group_of(const Group& wanted) {
  const auto is_it = [&wanted](const Group& group) {
    return group.channel == wanted.channel && group.payload_bytes == wanted.payload_bytes &&
           group.role == wanted.role && group.kind == wanted.kind;
  };
  const std::size_t expected = order_.empty() ? 0 : groups_[order_.back()].next;
  if (expected < group_count_ && is_it(groups_[expected])) return expected;
  std::size_t found = 0;
  while (found < group_count_ && !is_it(groups_[found])) ++found;
  if (found == group_count_) {
    if (++group_count_ > groups_.size()) groups_.emplace_back();
    Group& group = groups_[found];
    group.channel = wanted.channel;
    group.payload_bytes = wanted.payload_bytes;
    group.role = wanted.role;
    group.kind = wanted.kind;
    group.next = 0;
    group.records.clear();
  }
  if (!order_.empty()) groups_[order_.back()].next = static_cast<std::uint32_t>(found);
  return found;
}

bool ColumnEncoder::sort_into_groups(ByteSpan records) {
  group_count_ = 0;
  order_.clear();
  ByteSource source(records);
  while (!source.is_empty()) {
    const Opcode opcode = Opcode{source.take<std::uint8_t>()};
    const ByteSpan content = source.take_bytes(source.take<std::uint64_t>());
    if (!source.is_valid() || opcode != Opcode::message || content.size() < kMessageHeadBytes) return false;
    const ByteSpan payload = content.subspan(kMessageHeadBytes);
    const auto word_at = [payload](std::size_t at) {
      return payload.size() < at + sizeof(std::uint32_t) ? 0 : load<std::uint32_t>(payload.data() + at);
    };
    Group wanted;
    wanted.channel = load<std::uint16_t>(content.data());
    wanted.payload_bytes = static_cast<std::uint32_t>(payload.size());
    wanted.role = word_at(kRoleAt);
    wanted.kind = word_at(kKindAt);
    const std::size_t group = group_of(wanted);
    if (group >= kMaxGroups) return false;
    groups_[group].records.push_back(content.data());
    order_.push_back(static_cast<std::uint16_t>(group));
  }
  return !order_.empty();
}

bool ColumnEncoder::encode(ByteSpan records, Bytes& out) {
  if (!context_ || !sort_into_groups(records)) return false;
  table_.clear();
  put(table_, static_cast<std::uint32_t>(group_count_));
  put(table_, static_cast<std::uint32_t>(order_.size()));
  for (std::size_t i = 0; i < group_count_; ++i) {
    put(table_, groups_[i].channel);
    put(table_, groups_[i].payload_bytes);
    put(table_, static_cast<std::uint32_t>(groups_[i].records.size()));
  }
  put_bytes(table_, std::as_bytes(std::span(order_)));
  for (std::size_t i = 0; i < group_count_; ++i) put_group(groups_[i]);

  const std::size_t begin = out.size();
  put_channels(out);
  const std::size_t frame_at = out.size();
  out.resize(frame_at + ZSTD_compressBound(table_.size()));
  const std::size_t size =
      ZSTD_compress2(context_.get(), out.data() + frame_at, out.size() - frame_at, table_.data(), table_.size());
  const bool is_good = ZSTD_isError(size) == 0;
  out.resize(is_good ? frame_at + size : begin);
  return is_good;
}

void ColumnEncoder::put_channels(Bytes& out) const {
  std::vector<std::uint16_t> channels;
  for (std::size_t i = 0; i < group_count_; ++i) channels.push_back(groups_[i].channel);
  std::sort(channels.begin(), channels.end());
  channels.erase(std::unique(channels.begin(), channels.end()), channels.end());
  put(out, static_cast<std::uint16_t>(channels.size()));
  put_bytes(out, std::as_bytes(std::span(channels)));
}

void ColumnEncoder::put_group(const Group& group) {
  const std::size_t rows = group.records.size(), width = words_of_row(group.payload_bytes);
  words_.assign(rows * width, 0);
  for (std::size_t i = 0; i < rows; ++i) {
    const std::byte* const content = group.records[i];
    words_[0 * rows + i] = load<std::uint64_t>(content + 6);   // log time
    words_[1 * rows + i] = load<std::uint64_t>(content + 14);  // publish time
    words_[2 * rows + i] = load<std::uint32_t>(content + 2);   // sequence
    const std::byte* const payload = content + kMessageHeadBytes;
    // the first word has 4 bytes of padding in front, so that the numbers of the CDR are words
    std::size_t at = 0, room = kWord - kEncapsulation;
    for (std::size_t k = kFixedWords; k < width; ++k, room = kWord) {
      const std::size_t bytes = std::min<std::size_t>(room, group.payload_bytes - at);
      std::uint64_t word = 0;
      std::memcpy(reinterpret_cast<std::byte*>(&word) + (kWord - room), payload + at, bytes);
      words_[k * rows + i] = word;
      at += bytes;
    }
  }
  // heads of all columns, then their differences
  const std::size_t heads_at = table_.size();
  table_.resize(heads_at + width * kColumnHeadBytes);
  for (std::size_t k = 0; k < width; ++k) {
    put_at(table_, heads_at + k * kWord, words_[k * rows]);
    put_column(words_.data() + k * rows, rows, heads_at + width * kWord + 3 * k);
  }
}

void ColumnEncoder::put_column(const std::uint64_t* column, std::size_t rows, std::size_t head_at) {
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < rows; ++i) all |= column[i];
  const int shift = all == 0 ? 0 : std::countr_zero(all);
  const Best best = best_order(column, rows, shift);
  const std::size_t planes = (static_cast<std::size_t>(best.most_bits) + 7) / 8;
  put_at(table_, head_at, static_cast<std::uint8_t>(best.order));
  put_at(table_, head_at + 1, static_cast<std::uint8_t>(shift));
  put_at(table_, head_at + 2, static_cast<std::uint8_t>(planes));
  const std::size_t at = table_.size(), length = rows - 1;
  table_.resize(at + planes * length);
  std::byte* const out = table_.data() + at;
  Former former;
  former.add(column[0] >> shift);
  for (std::size_t i = 1; i < rows && planes > 0; ++i) {
    const std::uint64_t word = column[i] >> shift;
    std::uint64_t rest = folded(word - former.expected(best.order));
    for (std::size_t plane = 0; plane < planes; ++plane, rest >>= 8) {
      out[plane * length + i - 1] = static_cast<std::byte>(rest & 0xff);
    }
    former.add(word);
  }
}

// ---- decoding -------------------------------------------------------------------------------------------------

void ColumnDecoder::FreeContext::operator()(ZSTD_DCtx_s* context) const noexcept {
  ZSTD_freeDCtx(context);
}

ColumnDecoder::ColumnDecoder() : context_(ZSTD_createDCtx()) {}
ColumnDecoder::~ColumnDecoder() = default;

bool channels_of_columns(ByteSpan front, std::vector<std::uint16_t>& channels) {
  ByteSource source(front);
  channels.resize(source.take<std::uint16_t>());
  for (std::uint16_t& channel : channels) channel = source.take<std::uint16_t>();
  return source.is_valid();
}

bool ColumnDecoder::decode(ByteSpan coded, std::size_t size, Bytes& records, std::string& problem) {
  records.clear();
  problem = "the columns of the chunk are not well formed";
  if (!unpack(coded, size)) return false;
  ByteSource table(table_);
  const std::uint32_t groups = table.take<std::uint32_t>();
  const std::uint32_t messages = table.take<std::uint32_t>();
  if (!table.is_valid() || groups > kMaxGroups) return false;
  groups_.assign(groups, {});
  std::uint64_t rows = 0;
  if (!read_groups(table, size)) return false;
  for (const Group& group : groups_) rows += group.rows;
  const ByteSpan order = table.take_bytes(std::uint64_t{messages} * sizeof(std::uint16_t));
  if (!table.is_valid() || rows != messages) return false;
  for (const Group& group : groups_) {
    if (!read_group(table, group)) return false;
  }
  if (!table.is_empty() || !write_records(order, size, records)) return false;
  problem.clear();
  return true;
}

bool ColumnDecoder::unpack(ByteSpan coded, std::size_t size) {
  ByteSource source(coded);
  std::ignore = source.take_bytes(std::uint64_t{source.take<std::uint16_t>()} * sizeof(std::uint16_t));
  const ByteSpan frame = source.take_bytes(source.left());
  if (!source.is_valid() || !context_) return false;
  const unsigned long long claimed = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (claimed == ZSTD_CONTENTSIZE_UNKNOWN || claimed == ZSTD_CONTENTSIZE_ERROR) return false;
  if (claimed > kMaxTableFactor * size + kSpareTableBytes) return false;
  table_.resize(claimed);
  const std::size_t got = ZSTD_decompressDCtx(context_.get(), table_.data(), table_.size(), frame.data(), frame.size());
  return ZSTD_isError(got) == 0 && got == claimed;
}

// The rows of all groups must make up the records exactly, so that no claim allocates more memory than these.
bool ColumnDecoder::read_groups(ByteSource& table, std::size_t size) {
  std::uint64_t bytes = 0;
  std::size_t words = 0;
  for (Group& group : groups_) {
    group.channel = table.take<std::uint16_t>();
    group.payload_bytes = table.take<std::uint32_t>();
    group.rows = table.take<std::uint32_t>();
    if (!table.is_valid() || group.rows == 0) return false;
    const std::uint64_t record = kRecordHeadBytes + kMessageHeadBytes + std::uint64_t{group.payload_bytes};
    if (record > size || group.rows > size / record) return false;
    bytes += record * group.rows;
    if (bytes > size) return false;
    group.words_at = words;
    words += words_of_row(group.payload_bytes) * group.rows;
  }
  words_.resize(words);
  return bytes == size;
}

bool ColumnDecoder::read_group(ByteSource& table, const Group& group) {
  const std::size_t width = words_of_row(group.payload_bytes), length = group.rows - 1;
  const ByteSpan first = table.take_bytes(width * kWord), heads = table.take_bytes(width * 3);
  if (!table.is_valid()) return false;
  for (std::size_t k = 0; k < width; ++k) {
    const int order = std::to_integer<int>(heads[3 * k]), shift = std::to_integer<int>(heads[3 * k + 1]);
    const std::size_t planes = std::to_integer<std::size_t>(heads[3 * k + 2]);
    if (order < 1 || order > kMaxOrder || shift > 63 || planes > kWord) return false;
    const ByteSpan differences = table.take_bytes(planes * length);
    if (!table.is_valid()) return false;
    std::uint64_t* word = words_.data() + group.words_at + k;
    *word = load<std::uint64_t>(first.data() + k * kWord);
    Former former;
    former.add(*word >> shift);
    for (std::size_t i = 0; i < length; ++i) {
      std::uint64_t rest = 0;
      for (std::size_t plane = 0; plane < planes; ++plane) {
        rest |= std::to_integer<std::uint64_t>(differences[plane * length + i]) << (8 * plane);
      }
      const std::uint64_t value = former.expected(order) + unfolded(rest);
      former.add(value);
      word += width;
      *word = value << shift;
    }
  }
  return true;
}

bool ColumnDecoder::write_records(ByteSpan order, std::size_t size, Bytes& records) {
  records.reserve(size);
  for (std::size_t i = 0; i < order.size(); i += sizeof(std::uint16_t)) {
    const std::uint16_t number = load<std::uint16_t>(order.data() + i);
    if (number >= groups_.size() || groups_[number].taken == groups_[number].rows) return false;
    Group& group = groups_[number];
    const std::uint64_t* const row = words_.data() + group.words_at + words_of_row(group.payload_bytes) * group.taken++;
    const std::byte* const payload = reinterpret_cast<const std::byte*>(row + kFixedWords) + kEncapsulation;
    encode_message(records, {group.channel, static_cast<std::uint32_t>(row[2]), row[0], row[1],
                             ByteSpan(payload, group.payload_bytes)});
  }
  return records.size() == size;
}

}  // namespace slew::recording
