#include "daemon/threads/journal_sink.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

using Fields = std::vector<std::string>;

TEST(JournalFields, ALineBecomesItsSubjectAndItsPairs) {
  EXPECT_EQ(journal_fields("imu state=absent, continuing without: received=0 lost=2 device=/dev/ttyACM0"),
            (Fields{"SLAMD_SUBJECT=imu", "SLAMD_STATE=absent", "SLAMD_RECEIVED=0", "SLAMD_LOST=2",
                    "SLAMD_DEVICE=/dev/ttyACM0"}));
}

TEST(JournalFields, AValueInQuotationMarksKeepsItsBlanksAndSigns) {
  EXPECT_EQ(journal_fields("config state=refused, continuing: reason=\"f.yaml:2: a.b: not a=\"1\"\""),
            (Fields{"SLAMD_SUBJECT=config", "SLAMD_STATE=refused", "SLAMD_REASON=f.yaml:2: a.b: not a=\"1\""}));
}

TEST(JournalFields, ListsAreOneValueAndOddKeysBecomeFieldNames) {
  EXPECT_EQ(journal_fields("pose status=DEGRADED reasons=no_imu,imu_gap rejected_bad-crc=3"),
            (Fields{"SLAMD_SUBJECT=pose", "SLAMD_STATUS=DEGRADED", "SLAMD_REASONS=no_imu,imu_gap",
                    "SLAMD_REJECTED_BAD_CRC=3"}));
}

TEST(JournalFields, WordsWithoutAValueAndCutLinesAreNoFields) {
  EXPECT_EQ(journal_fields(""), Fields{"SLAMD_SUBJECT="});
  EXPECT_EQ(journal_fields("started"), Fields{"SLAMD_SUBJECT=started"});
  EXPECT_EQ(journal_fields("x = =y a="), (Fields{"SLAMD_SUBJECT=x", "SLAMD_A="}));
  EXPECT_EQ(journal_fields("x reason=\"cut"), (Fields{"SLAMD_SUBJECT=x", "SLAMD_REASON=cut"}));
}

}  // namespace
}  // namespace slamd
