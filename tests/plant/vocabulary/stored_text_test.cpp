#include "plant/vocabulary/stored_text.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <thread>
#include <vector>

#include "plant/vocabulary/checksum.h"

namespace servomill::stored_text_test {
namespace {

constexpr std::size_t kPiece = StoredText::kPiece;

std::string random_text(std::size_t size) {
  std::mt19937 dice(7);
  std::string out(size, ' ');
  for (char& c : out) c = static_cast<char>(dice() % 256);
  return out;
}

StoredText appended(const std::string& text, std::size_t step, std::size_t most_in_memory) {
  StoredText out({}, most_in_memory);
  for (std::size_t at = 0; at < text.size(); at += step) {
    out.append(std::string_view(text).substr(at, step));
  }
  return out;
}

// Lengths about the ends of pieces.
TEST(StoredText, IsTheSameInMemoryAndOnTheDisk) {
  for (const std::size_t size :
       {std::size_t{1}, kPiece - 1, kPiece, kPiece + 1, 3 * kPiece, 3 * kPiece + kPiece / 3}) {
    const std::string text = random_text(size);
    for (const std::size_t most : {std::size_t{0}, kPiece, 4 * kPiece}) {
      for (const std::size_t step : {std::size_t{999}, kPiece, 5 * kPiece}) {
        const StoredText stored = appended(text, step, most);
        EXPECT_EQ(stored.is_on_disk(), size > most) << size << " " << most;
        EXPECT_EQ(stored.size(), size);
        EXPECT_TRUE(stored.all() == text) << size << " " << most << " " << step;
        EXPECT_TRUE(stored == StoredText(text)) << size << " " << most << " " << step;
        EXPECT_EQ(crc64_in_pieces(stored), crc64(text)) << size << " " << most;
      }
    }
  }
}

TEST(StoredText, MayBeEmpty) {
  for (const std::size_t most : {std::size_t{0}, kPiece}) {
    StoredText none({}, most);
    none.append("");
    none.each_piece([](std::string_view) { FAIL() << "nothing is there"; });
    EXPECT_TRUE(none.empty());
    EXPECT_FALSE(none.is_on_disk());
    EXPECT_EQ(none.all(), "");
    EXPECT_TRUE(none == StoredText());
    EXPECT_EQ(none.copy(nullptr, 10, 0), 0U);
  }
}

TEST(StoredText, IsInMemoryUpToItsLimit) {
  EXPECT_FALSE(StoredText(std::string(100, 'x'), 100).is_on_disk());
  StoredText text(std::string(101, 'x'), 100);
  EXPECT_TRUE(text.is_on_disk());
  StoredText announced({}, 100);
  announced.reserve(100);
  EXPECT_FALSE(announced.is_on_disk());
  announced.reserve(101);
  EXPECT_TRUE(announced.is_on_disk());
  announced.append(std::string(101, 'x'));
  EXPECT_TRUE(announced == text);
}

TEST(StoredText, DiffersByOneByteAnywhere) {
  const std::string text = random_text(2 * kPiece + 5);
  const StoredText stored(text, 0);
  for (const std::size_t at : {std::size_t{0}, kPiece - 1, kPiece, 2 * kPiece, text.size() - 1}) {
    std::string other = text;
    other[at] = static_cast<char>(other[at] + 1);
    EXPECT_FALSE(stored == StoredText(other, 0)) << at;
    EXPECT_FALSE(stored == StoredText(other)) << at;
  }
  EXPECT_FALSE(stored == StoredText(text + "x", 0));
}

TEST(StoredText, HandsOutPiecesOfOneLength) {
  const StoredText stored = appended(random_text(2 * kPiece + 5), 1000, 0);
  std::vector<std::size_t> sizes;
  stored.each_piece([&](std::string_view piece) { sizes.push_back(piece.size()); });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{kPiece, kPiece, 5}));
}

TEST(StoredText, CopiesFromAnyPlace) {
  const std::string text = random_text(2 * kPiece + 500);
  for (const std::size_t most_in_memory : {std::size_t{0}, 4 * kPiece}) {
    const StoredText stored(text, most_in_memory);
    std::string room(700, ' ');
    for (const std::size_t at :
         {std::size_t{0}, kPiece - 300, 2 * kPiece - 300, 2 * kPiece, text.size() - 699}) {
      const std::size_t count = stored.copy(room.data(), 700, at);
      EXPECT_EQ(count, std::min<std::size_t>(700, text.size() - at)) << at;
      EXPECT_TRUE(room.substr(0, count) == text.substr(at, count)) << at;
    }
    EXPECT_EQ(stored.copy(room.data(), 700, text.size()), 0U);
    EXPECT_EQ(stored.copy(room.data(), 700, text.size() + 1), 0U);
  }
}

TEST(StoredText, IsReadByManyThreads) {
  const std::string text = random_text(5 * kPiece);
  const StoredText stored(text, 0);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] { EXPECT_TRUE(stored.all() == text); });
  }
}

}  // namespace
}  // namespace servomill::stored_text_test
