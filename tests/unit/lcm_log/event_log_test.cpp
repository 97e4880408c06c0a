// SPDX-License-Identifier: Apache-2.0
// Event logs: liblcm reads what is written and the reverse; cut logs.
#include <gtest/gtest.h>

#include <lcm/eventlog.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "lcm_log/event_log.h"
#include "tests/support/temporary_folder.h"

namespace event_log_test {

using namespace slew::lcm_log;

std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span<const char>(text.data(), text.size()));
}

std::string two_events() {
  std::string log;
  EventLogWriter writer;
  writer.add({0, "A", as_bytes("first")}, log);
  writer.add({1'500'000, "CRANE_INPUT", as_bytes(std::string_view("\0\1", 2))}, log);
  return log;
}

TEST(EventLog, LiblcmReadsWhatIsWritten) {
  const slew::testing::TemporaryFolder folder("lcm_event_log");
  const std::string path = (folder.path() / "log").string();
  std::ofstream(path, std::ios::binary) << two_events();
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "r");
  ASSERT_NE(log, nullptr);
  lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log);
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->eventnum, 0);
  EXPECT_EQ(event->timestamp, 0);
  EXPECT_EQ(std::string(static_cast<const char*>(event->data), static_cast<std::size_t>(event->datalen)), "first");
  lcm_eventlog_free_event(event);
  event = lcm_eventlog_read_next_event(log);
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->eventnum, 1);
  EXPECT_EQ(event->timestamp, 1'500'000);
  EXPECT_STREQ(event->channel, "CRANE_INPUT");
  EXPECT_EQ(event->datalen, 2);
  lcm_eventlog_free_event(event);
  EXPECT_EQ(lcm_eventlog_read_next_event(log), nullptr);
  lcm_eventlog_destroy(log);
}

TEST(EventLog, ALogOfLiblcmIsRead) {
  const slew::testing::TemporaryFolder folder("lcm_event_log");
  const std::string path = (folder.path() / "log").string();
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "w");
  ASSERT_NE(log, nullptr);
  char channel[] = "CRANE", data[] = "abc";
  lcm_eventlog_event_t event{};
  event.timestamp = 42;
  event.channellen = 5;
  event.channel = channel;
  event.datalen = 3;
  event.data = data;
  ASSERT_EQ(lcm_eventlog_write_event(log, &event), 0);
  lcm_eventlog_destroy(log);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EventLogReader reader(bytes);
  Event read;
  ASSERT_TRUE(reader.next(read));
  EXPECT_EQ(read.time_us, 42);
  EXPECT_EQ(read.channel, "CRANE");
  EXPECT_EQ(read.data.size(), 3u);
  EXPECT_FALSE(reader.next(read));
  EXPECT_EQ(reader.damage(), "");
}

TEST(EventLog, ACutLogGivesTheEventsBeforeTheCut) {
  const std::string whole = two_events();
  const std::size_t first = 28 + 1 + 5;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EventLogReader reader(std::string_view(whole).substr(0, size));
    Event event;
    std::int64_t count = 0;
    while (reader.next(event)) ++count;
    EXPECT_EQ(count, size >= first ? 1 : 0) << size;
    EXPECT_EQ(reader.damage().empty(), size == 0 || size == first) << size;
  }
}

TEST(EventLog, LengthsAreNotTrusted) {
  for (const std::size_t place : {20u, 24u}) {
    for (const unsigned char byte : {0x7f, 0x80, 0xff}) {
      std::string log = two_events();
      log[place] = static_cast<char>(byte);
      EventLogReader reader(log);
      Event event;
      EXPECT_FALSE(reader.next(event));
      EXPECT_EQ(reader.damage(), "is cut or damaged behind event 0 (byte 0)");
    }
  }
}

}  // namespace event_log_test
