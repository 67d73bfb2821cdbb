#include "plant/vocabulary/checksum.h"

#include <gtest/gtest.h>

namespace servomill::checksum_test {
namespace {

// The check value of CRC-64/XZ in the catalogue of parametrised CRC algorithms.
TEST(Checksum, IsThatOfXz) {
  EXPECT_EQ(crc64("123456789"), 0x995DC9BBDF1939FAU);
  EXPECT_EQ(crc64(""), 0U);
}

}  // namespace
}  // namespace servomill::checksum_test
