// SPDX-License-Identifier: Apache-2.0
#include "recording/sort_window.h"

#include <algorithm>
#include <tuple>

namespace slew::recording {
namespace {

constexpr std::size_t kAlignment = 8;  // alignment of blocks; the head of a block fills it

constexpr std::size_t rounded_up(std::size_t size) noexcept {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

SortWindow::SortWindow(StepIndex steps, std::size_t bytes, std::size_t messages)
    : steps_(steps), capacity_(messages), ring_(rounded_up(bytes)) {
  static_assert(sizeof(BlockHead) == kAlignment);
  entries_.reserve(messages);
}

bool SortWindow::is_later(const WindowEntry& a, const WindowEntry& b) const noexcept {
  const auto key = [](const WindowEntry& e) {
    return std::tie(e.stamp.epoch, e.stamp.step, e.channel, e.stamp.sequence);
  };
  if (const auto order = key(a) <=> key(b); order != 0) return order > 0;
  // two publishers with the same sequence on one channel: order by content, not by arrival
  const ByteSpan payload_a = payload_of(a);
  const ByteSpan payload_b = payload_of(b);
  const int bytes = std::memcmp(payload_a.data(), payload_b.data(), std::min(payload_a.size(), payload_b.size()));
  if (bytes != 0) return bytes > 0;
  return std::tie(a.size, a.arrival) > std::tie(b.size, b.arrival);
}

SortWindow::PushResult SortWindow::push(const MessageStamp& stamp, std::uint16_t channel, ByteSpan payload) noexcept {
  if (payload.size() > ring_.size() - std::min(ring_.size(), sizeof(BlockHead))) return PushResult::too_large;
  if (entries_.size() == capacity_) return PushResult::full;
  std::size_t block = 0;
  if (!allocate(payload.size(), block)) return PushResult::full;
  if (!payload.empty()) std::memcpy(ring_.data() + block + sizeof(BlockHead), payload.data(), payload.size());
  entries_.push_back({stamp, channel, static_cast<std::uint32_t>(payload.size()), arrivals_++, block});
  std::push_heap(entries_.begin(), entries_.end(),
                 [this](const WindowEntry& a, const WindowEntry& b) { return is_later(a, b); });
  if (std::tie(stamp.epoch, stamp.step) > std::tie(newest_epoch_, newest_step_)) {
    newest_epoch_ = stamp.epoch;
    newest_step_ = stamp.step;
  }
  return PushResult::taken;
}

bool SortWindow::is_first_due() const noexcept {
  if (is_empty()) return false;
  const MessageStamp& stamp = first().stamp;
  // a former epoch ends after the reset plus the held span of steps
  if (stamp.epoch < newest_epoch_) return newest_step_ >= steps_;
  return stamp.step <= newest_step_ - steps_;
}

bool SortWindow::is_first_up_to(std::uint32_t epoch, StepIndex step) const noexcept {
  return !is_empty() && std::tie(first().stamp.epoch, first().stamp.step) <= std::tie(epoch, step);
}

ByteSpan SortWindow::payload_of(const WindowEntry& entry) const noexcept {
  return ByteSpan(ring_).subspan(entry.block + sizeof(BlockHead), entry.size);
}

void SortWindow::pop_first() noexcept {
  std::pop_heap(entries_.begin(), entries_.end(),
                [this](const WindowEntry& a, const WindowEntry& b) { return is_later(a, b); });
  release(entries_.back().block);
  entries_.pop_back();
}

SortWindow::BlockHead SortWindow::head_at(std::size_t block) const noexcept {
  BlockHead head;
  std::memcpy(&head, ring_.data() + block, sizeof head);
  return head;
}

void SortWindow::set_head(std::size_t block, BlockHead head) noexcept {
  std::memcpy(ring_.data() + block, &head, sizeof head);
}

bool SortWindow::allocate(std::size_t size, std::size_t& block) noexcept {
  if (used_ == 0) tail_ = end_ = 0;
  const std::size_t needed = sizeof(BlockHead) + rounded_up(size);
  const std::size_t behind = ring_.size() - end_;
  const std::size_t skipped = needed > behind ? behind : 0;
  if (needed + skipped > ring_.size() - used_) return false;
  // the rest before the wrap becomes an unused block
  if (skipped > 0) {
    set_head(end_, {static_cast<std::uint32_t>(skipped), 0});
    used_ += skipped;
    end_ = 0;
  }
  block = end_;
  set_head(block, {static_cast<std::uint32_t>(needed), 1});
  used_ += needed;
  end_ = end_ + needed == ring_.size() ? 0 : end_ + needed;
  return true;
}

void SortWindow::release(std::size_t block) noexcept {
  set_head(block, {head_at(block).size, 0});
  // the ring releases blocks from its oldest on
  while (used_ > 0 && head_at(tail_).is_live == 0) {
    const std::size_t size = head_at(tail_).size;
    used_ -= size;
    tail_ = tail_ + size == ring_.size() ? 0 : tail_ + size;
  }
}

}  // namespace slew::recording
