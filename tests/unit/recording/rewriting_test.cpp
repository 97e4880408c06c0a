// SPDX-License-Identifier: Apache-2.0
// Slices of a recording, and their join: the same messages, bytes and times.
#include "recording/rewriting.h"

#include "sample_session.h"

namespace slew::recording {
namespace rewriting_test {

constexpr StepIndex kSteps = 25;
constexpr std::uint64_t kStepNs = 1'000'000;

class Rewriting : public ::testing::Test {
 protected:
  void SetUp() override { std::ignore = write_sample(scratch_ / "whole.mcap", kSteps, Ending::closed); }

  std::unique_ptr<Reader> open(const std::string& name) {
    std::unique_ptr<Reader> reader;
    EXPECT_EQ(Reader::open(scratch_ / name, reader).text, "");
    return reader;
  }
  Status cut(const std::string& from, const std::string& to, std::uint64_t first_step, std::uint64_t end_step,
             SliceDef def = {}) {
    def.from_ns = first_step * kStepNs;
    if (end_step > 0) def.to_ns = end_step * kStepNs;
    return slice(*open(from), scratch_ / to, def, counts_);
  }
  Status put_together(const std::vector<std::string>& names, const std::string& to) {
    std::vector<std::unique_ptr<Reader>> readers;
    std::vector<const Reader*> parts;
    for (const std::string& name : names) {
      readers.push_back(open(name));
      parts.push_back(readers.back().get());
    }
    return join(parts, scratch_ / to, small_limits(), counts_);
  }

  ScratchDirectory scratch_;
  RewriteCounts counts_;
};

TEST_F(Rewriting, ASliceHasTheMessagesOfItsTimesAndTheSession) {
  ASSERT_EQ(cut("whole.mcap", "part.mcap", 5, 9).text, "");
  const std::unique_ptr<Reader> part = open("part.mcap");
  EXPECT_EQ(part->verify().text, "");
  const std::vector<KnownMessage> all = sample_messages(kSteps);
  EXPECT_EQ(read_all(*part), std::vector<KnownMessage>(all.begin() + 10, all.begin() + 18));
  EXPECT_EQ(part->identity().session_id, sample_identity().session_id);
  EXPECT_EQ(part->find_metadata(kSummaryName), nullptr) << "it counts the messages of the source";
  EXPECT_EQ(*part->find_metadata(kSliceName),
            (TextMap{{"of", "whole.mcap"}, {"from_ns", "5000000"}, {"to_ns", "9000000"}}));
  Bytes content;
  EXPECT_EQ(part->read_attachment(kAttachmentName, content).text, "");
  EXPECT_EQ(as_text(content), kAttachmentText);
  EXPECT_EQ(counts_.messages, 8u);
}

TEST_F(Rewriting, TopicsThatAreKeptWholeBeginBeforeTheSlice) {
  SliceDef def;
  def.whole_topics = {kTickTopic};
  ASSERT_EQ(cut("whole.mcap", "part.mcap", 5, 6, def).text, "");
  EXPECT_EQ(read_all(*open("part.mcap"), nullptr, {{kTickTopic}}).size(), 6u);
  EXPECT_EQ(read_all(*open("part.mcap"), nullptr, {{kStateTopic}}).size(), 1u);
}

TEST_F(Rewriting, SlicesThatMeetAreTheWholeAgain) {
  SliceDef def;
  def.whole_topics = {kTickTopic};
  ASSERT_EQ(cut("whole.mcap", "a.mcap", 0, 7, def).text, "");
  ASSERT_EQ(cut("whole.mcap", "b.mcap", 7, 8, def).text, "");
  def.limits.coding = ChunkCoding::columns;
  ASSERT_EQ(cut("whole.mcap", "c.mcap", 8, 0, def).text, "");
  ASSERT_EQ(put_together({"c.mcap", "a.mcap", "b.mcap"}, "joined.mcap").text, "");
  EXPECT_TRUE(counts_.gaps.empty());
  EXPECT_EQ(read_all(*open("joined.mcap")), sample_messages(kSteps));
  EXPECT_EQ(open("joined.mcap")->verify().text, "");
  EXPECT_EQ(open("joined.mcap")->find_metadata(kSliceName), nullptr);
}

TEST_F(Rewriting, AnotherCodingHasTheSameMessages) {
  SliceDef def;
  def.limits.coding = ChunkCoding::columns;
  ASSERT_EQ(cut("whole.mcap", "columns.mcap", 0, 0, def).text, "");
  EXPECT_EQ(open("columns.mcap")->identity().format_version, 2);
  ASSERT_EQ(cut("columns.mcap", "zstd.mcap", 0, 0).text, "");
  EXPECT_EQ(open("zstd.mcap")->identity().format_version, 1);
  EXPECT_EQ(read_all(*open("columns.mcap")), sample_messages(kSteps));
  EXPECT_EQ(read_all(*open("zstd.mcap")), sample_messages(kSteps));
}

TEST_F(Rewriting, AGapBetweenPartsIsNamed) {
  ASSERT_EQ(cut("whole.mcap", "a.mcap", 0, 7).text, "");
  ASSERT_EQ(cut("whole.mcap", "b.mcap", 12, 0).text, "");
  ASSERT_EQ(put_together({"a.mcap", "b.mcap"}, "joined.mcap").text, "");
  ASSERT_EQ(counts_.gaps.size(), 1u);
  EXPECT_EQ(counts_.gaps[0], "no part has the time from 0.007 s to 0.012 s");
}

TEST_F(Rewriting, PartsThatOverlapOrAreOfTwoSessionsAreRefused) {
  ASSERT_EQ(cut("whole.mcap", "a.mcap", 0, 7).text, "");
  ASSERT_EQ(cut("whole.mcap", "b.mcap", 6, 0).text, "");
  const Status overlap = put_together({"a.mcap", "b.mcap"}, "joined.mcap");
  EXPECT_EQ(overlap.code, ExitCode::bad_input);
  EXPECT_NE(overlap.text.find("both have the time from 0.006 s to 0.007 s"), std::string::npos) << overlap.text;
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "joined.mcap"));

  SessionIdentity other = sample_identity();
  other.session_id = "ffeeddccbbaa99887766554433221100";
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch_ / "other.mcap", other, small_limits(), writer).text, "");
  ASSERT_EQ(writer->close({}).text, "");
  EXPECT_NE(put_together({"a.mcap", "other.mcap"}, "joined.mcap").text.find("are recordings of two sessions"),
            std::string::npos);
}

TEST_F(Rewriting, TimesWithoutMessagesAndFilesThatExistAreRefused) {
  const Status late = cut("whole.mcap", "part.mcap", 25, 0);
  EXPECT_EQ(late.code, ExitCode::bad_input);
  EXPECT_NE(late.text.find("goes from 0 s to 0.024 s and has no message in this time"), std::string::npos) << late.text;
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "part.mcap"));
  const std::string before = file_content(scratch_ / "whole.mcap");
  EXPECT_EQ(cut("whole.mcap", "whole.mcap", 0, 0).code, ExitCode::storage);
  EXPECT_EQ(file_content(scratch_ / "whole.mcap"), before);
}

TEST_F(Rewriting, OfADamagedSourceLeavesNoFile) {
  std::string bytes = file_content(scratch_ / "whole.mcap");
  const ChunkPlace place = chunks_of(scratch_ / "whole.mcap").at(2);
  bytes[place.begin + 60] ^= 1;  // in the compressed records
  write_file(scratch_ / "damaged.mcap", bytes);
  EXPECT_EQ(cut("damaged.mcap", "part.mcap", 0, 0).code, ExitCode::bad_input);
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "part.mcap"));
}

}  // namespace rewriting_test
}  // namespace slew::recording
