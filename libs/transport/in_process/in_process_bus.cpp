// SPDX-License-Identifier: Apache-2.0
#include "transport/in_process/in_process_bus.h"

#include <algorithm>
#include <chrono>

#include "core/check.h"
#include "core/time.h"

namespace slew::transport {
namespace {

constexpr std::size_t kFirstCapacity = 64;  // messages of a new inbox

}  // namespace

InProcessEndpoint::InProcessEndpoint(InProcessBus& bus, InProcessOptions options)
    : bus_(bus), options_(std::move(options)) {
  taken_.bytes.reserve(InProcessBus::kSlotBytes);
  const std::lock_guard lock(bus_.mutex_);
  // the messages that earlier writers keep for late readers
  for (const InProcessEndpoint* writer : bus_.endpoints_) {
    for (const Message& message : writer->kept_)
      receive(message.topic, message.bytes, message.source_ns, writer->number_);
  }
  number_ = ++bus_.last_number_;
  bus_.endpoints_.push_back(this);
}

InProcessEndpoint::~InProcessEndpoint() {
  const std::lock_guard lock(bus_.mutex_);
  std::erase(bus_.endpoints_, this);
}

Status InProcessEndpoint::check_written(wire::Topic topic) const {
  if (options_.writes.contains(topic)) return Status::ok();
  return Status::error(ExitCode::failed, std::string("internal error: ") + options_.role +
                                             " publishes on the undeclared topic " + traits(topic).name);
}

Status InProcessEndpoint::publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept {
  if (Status written = check_written(topic); !written.is_ok()) return written;
  const std::int64_t now = wall_clock_ns();
  const std::lock_guard lock(bus_.mutex_);
  keep(topic, bytes, now);
  for (InProcessEndpoint* reader : bus_.endpoints_) {
    if (reader != this) reader->receive(topic, bytes, now, number_);
  }
  return Status::ok();
}

Status InProcessEndpoint::publish_object(const MessageObject& object, std::vector<std::byte>& buffer) noexcept {
  SLEW_ASSERT(traits(object.topic).kept == 0);  // late readers get bytes
  if (Status written = check_written(object.topic); !written.is_ok()) return written;
  buffer.clear();
  const std::int64_t now = wall_clock_ns();
  const std::lock_guard lock(bus_.mutex_);
  if (is_read_as_bytes(object.topic)) object.encode(object.message.get(), buffer);
  for (InProcessEndpoint* reader : bus_.endpoints_) {
    if (reader == this || !reader->options_.reads.contains(object.topic)) continue;
    if (reader->options_.objects.contains(object.topic)) {
      reader->receive(object, now);
    } else {
      reader->receive(object.topic, buffer, now, number_);
    }
  }
  return Status::ok();
}

bool InProcessEndpoint::needs_bytes(wire::Topic topic) const noexcept {
  const std::lock_guard lock(bus_.mutex_);
  return is_read_as_bytes(topic);
}

// the bus's mutex is held
bool InProcessEndpoint::is_read_as_bytes(wire::Topic topic) const noexcept {
  return std::any_of(bus_.endpoints_.begin(), bus_.endpoints_.end(), [&](const InProcessEndpoint* reader) {
    const InProcessOptions& options = reader->options_;
    return reader != this && options.reads.contains(topic) && !options.objects.contains(topic);
  });
}

void InProcessEndpoint::keep(wire::Topic topic, std::span<const std::byte> bytes, std::int64_t source_ns) {
  const std::int32_t depth = traits(topic).kept;
  if (depth == 0) return;
  const auto is_of_topic = [topic](const Message& message) { return message.topic == topic; };
  if (std::count_if(kept_.begin(), kept_.end(), is_of_topic) == depth) {
    kept_.erase(std::find_if(kept_.begin(), kept_.end(), is_of_topic));
  }
  kept_.push_back({topic, source_ns, {bytes.begin(), bytes.end()}, number_});
}

// the bus's mutex is held
void InProcessEndpoint::receive(wire::Topic topic, std::span<const std::byte> bytes, std::int64_t source_ns,
                                std::uint64_t writer) {
  if (!options_.reads.contains(topic)) return;
  Message& slot = add_message(topic, source_ns);
  slot.writer = topic == wire::Topic::controller_input ? writer : 0;
  slot.bytes.assign(bytes.begin(), bytes.end());
}

// the bus's mutex is held
void InProcessEndpoint::receive(const MessageObject& object, std::int64_t source_ns) {
  Message& slot = add_message(object.topic, source_ns);
  slot.bytes.clear();
  slot.object = object.message;
  slot.header = object.header;
}

InProcessEndpoint::Message& InProcessEndpoint::add_message(wire::Topic topic, std::int64_t source_ns) {
  if (count_ == inbox_.size() && count_ < InProcessBus::kInboxLimit) grow();
  if (count_ == inbox_.size()) {
    first_ = (first_ + 1) % inbox_.size();
    --count_;
    ++dropped_;
  }
  Message& slot = inbox_[(first_ + count_) % inbox_.size()];
  slot.topic = topic;
  slot.source_ns = source_ns;
  slot.writer = 0;
  slot.object.reset();
  slot.header = nullptr;
  ++count_;
  if (is_waiting_) has_message_.notify_one();
  return slot;
}

// twice the places, the oldest message first
void InProcessEndpoint::grow() {
  std::rotate(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(first_), inbox_.end());
  first_ = 0;
  const std::size_t old = inbox_.size();
  inbox_.resize(std::max(kFirstCapacity, 2 * old));
  for (std::size_t i = old; i < inbox_.size(); ++i) inbox_[i].bytes.reserve(InProcessBus::kSlotBytes);
}

bool InProcessEndpoint::take(Received& message) {
  const std::lock_guard lock(bus_.mutex_);
  if (count_ == 0) return false;
  std::swap(taken_, inbox_[first_]);
  first_ = (first_ + 1) % inbox_.size();
  --count_;
  message = {taken_.topic, taken_.bytes, taken_.source_ns, taken_.writer, std::move(taken_.object), taken_.header};
  return true;
}

WriterSight InProcessEndpoint::see_writer(wire::Topic, std::uint64_t writer) {
  const std::lock_guard lock(bus_.mutex_);
  const bool is_there = std::any_of(bus_.endpoints_.begin(), bus_.endpoints_.end(),
                                    [writer](const InProcessEndpoint* one) { return one->number_ == writer; });
  return {.has_left = writer != 0 && !is_there};
}

void InProcessEndpoint::wait_until(std::int64_t monotonic_deadline_ns) {
  const std::chrono::steady_clock::time_point deadline{std::chrono::nanoseconds(monotonic_deadline_ns)};
  std::unique_lock lock(bus_.mutex_);
  is_waiting_ = true;
  has_message_.wait_until(lock, deadline, [this] { return count_ > 0; });
  is_waiting_ = false;
}

std::size_t InProcessEndpoint::matched_readers(wire::Topic topic) const {
  const std::lock_guard lock(bus_.mutex_);
  return static_cast<std::size_t>(std::count_if(
      bus_.endpoints_.begin(), bus_.endpoints_.end(),
      [&](const InProcessEndpoint* reader) { return reader != this && reader->options_.reads.contains(topic); }));
}

std::vector<std::string> InProcessEndpoint::discovered_writers(wire::Topic topic) {
  std::vector<std::string> writers;
  const std::lock_guard lock(bus_.mutex_);
  for (const InProcessEndpoint* endpoint : bus_.endpoints_) {
    if (!endpoint->options_.writes.contains(topic)) continue;
    writers.push_back(endpoint->options_.role + " in this process, type " + traits(topic).type_name);
  }
  return writers;
}

std::uint64_t InProcessEndpoint::dropped() const {
  const std::lock_guard lock(bus_.mutex_);
  return dropped_;
}

}  // namespace slew::transport
