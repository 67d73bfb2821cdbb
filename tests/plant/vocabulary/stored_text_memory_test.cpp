// The memory that a long text takes from the heap.
#include <gtest/gtest.h>

#include <string>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/scratch_file.h"
#include "plant/vocabulary/stored_text.h"
#include "tests/counting_new.h"

namespace servomill::stored_text_memory_test {
namespace {

// 20 MB of text: a piece or two are in memory, whatever is done with it.
TEST(StoredText, TakesTheMemoryOfAFewPieces) {
  constexpr std::size_t kBytes = 20'000'000, kPiece = StoredText::kPiece;
  const std::string line = "G1 X12.3456789 Y-1.2345678 Z0.1234567\n";
  const std::uint64_t temporary = ScratchFile::temporary_bytes();
  const std::size_t before = bytes_in_use;
  most_bytes_in_use = before;
  {
    StoredText text;
    while (text.size() < kBytes) text.append(line);
    EXPECT_GE(most_bytes_in_use - before, StoredText::kMaxInMemory) << "memory is counted";
    EXPECT_LE(most_bytes_in_use - before, 4 * StoredText::kMaxInMemory);
    EXPECT_LE(bytes_in_use - before, 3 * kPiece);
    EXPECT_GE(ScratchFile::temporary_bytes() - temporary, kBytes - kPiece);
    most_bytes_in_use = bytes_in_use;
    const std::size_t written = bytes_in_use;
    EXPECT_TRUE(text == text);
    EXPECT_NE(crc64_in_pieces(text), 0U);
    EXPECT_LE(most_bytes_in_use - written, 3 * kPiece);
  }
  EXPECT_EQ(ScratchFile::temporary_bytes(), temporary);
}

}  // namespace
}  // namespace servomill::stored_text_memory_test
