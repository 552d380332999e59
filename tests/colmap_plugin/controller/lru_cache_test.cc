#include "colmap_plugin/controller/lru_cache.h"

#include <string>

#include <gtest/gtest.h>

namespace hpm {
namespace {

using Cache = LruCache<int, std::string>;

std::shared_ptr<const std::string> Text(const std::string& text) {
  return std::make_shared<const std::string>(text);
}

TEST(LruCache, FindsWhatWasInserted) {
  Cache cache(100);
  EXPECT_EQ(cache.Find(1), nullptr);
  cache.Insert(1, Text("one"), 10);
  ASSERT_NE(cache.Find(1), nullptr);
  EXPECT_EQ(*cache.Find(1), "one");
  EXPECT_EQ(cache.num_bytes(), 10u);
}

TEST(LruCache, DropsTheValueUsedLongestAgo) {
  Cache cache(30);
  cache.Insert(1, Text("one"), 10);
  cache.Insert(2, Text("two"), 10);
  cache.Insert(3, Text("three"), 10);
  cache.Find(1);
  cache.Insert(4, Text("four"), 10);
  EXPECT_NE(cache.Find(1), nullptr);
  EXPECT_EQ(cache.Find(2), nullptr);
  EXPECT_NE(cache.Find(3), nullptr);
  EXPECT_NE(cache.Find(4), nullptr);
}

TEST(LruCache, NeverHoldsMoreThanItsBound) {
  Cache cache(100);
  for (int i = 0; i < 200; ++i) {
    cache.Insert(i, Text("value"), 1 + i * 37 % 60);
    EXPECT_LE(cache.num_bytes(), 100u);
    EXPECT_NE(cache.Find(i), nullptr);
  }
}

TEST(LruCache, OneLargeValuePushesOutSeveral) {
  Cache cache(30);
  for (int i = 0; i < 3; ++i) cache.Insert(i, Text("small"), 10);
  cache.Insert(9, Text("large"), 25);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(cache.Find(i), nullptr);
  EXPECT_EQ(cache.num_bytes(), 25u);
}

TEST(LruCache, ValueBeyondTheBoundIsNotKeptAndPushesNothingOut) {
  Cache cache(30);
  cache.Insert(1, Text("one"), 10);
  cache.Insert(2, Text("huge"), 31);
  EXPECT_EQ(cache.Find(2), nullptr);
  EXPECT_NE(cache.Find(1), nullptr);
}

TEST(LruCache, InsertingAKeyTwiceCountsItOnce) {
  Cache cache(30);
  cache.Insert(1, Text("one"), 10);
  cache.Insert(1, Text("again"), 10);
  EXPECT_EQ(cache.num_bytes(), 10u);
  EXPECT_NE(cache.Find(1), nullptr);
}

TEST(LruCache, ADroppedValueLivesOnWithItsUsers) {
  Cache cache(10);
  cache.Insert(1, Text("one"), 10);
  const auto held = cache.Find(1);
  cache.Insert(2, Text("two"), 10);
  EXPECT_EQ(cache.Find(1), nullptr);
  EXPECT_EQ(*held, "one");
}

TEST(LruCache, ErasesWhatIsUnwanted) {
  Cache cache(30);
  for (const int key : {1, 2, 3}) cache.Insert(key, Text("text"), 10);
  cache.EraseIf([](int key) { return key != 2; });
  EXPECT_EQ(cache.Find(1), nullptr);
  EXPECT_NE(cache.Find(2), nullptr);
  EXPECT_EQ(cache.Find(3), nullptr);
  EXPECT_EQ(cache.num_bytes(), 10u);
  cache.Insert(1, Text("one"), 20);
  EXPECT_NE(cache.Find(1), nullptr);
  EXPECT_NE(cache.Find(2), nullptr);
}

TEST(LruCache, ASpareValueTakesNoRoomFromOthers) {
  Cache cache(30);
  cache.Insert(1, Text("one"), 20);
  cache.InsertSpare(2, Text("two"), 20);
  EXPECT_EQ(cache.Peek(2), nullptr);
  cache.InsertSpare(3, Text("three"), 10);
  EXPECT_NE(cache.Peek(3), nullptr);
  cache.Insert(4, Text("four"), 10);
  EXPECT_EQ(cache.Peek(3), nullptr);
  EXPECT_NE(cache.Find(1), nullptr);
  EXPECT_NE(cache.Find(4), nullptr);
}

TEST(LruCache, ASpareValueThatIsUsedIsSpareNoMore) {
  Cache cache(30);
  cache.InsertSpare(1, Text("one"), 10);
  cache.Insert(2, Text("two"), 10);
  cache.Insert(3, Text("three"), 10);
  cache.Find(1);
  cache.Insert(4, Text("four"), 10);
  EXPECT_NE(cache.Find(1), nullptr);
  EXPECT_EQ(cache.Find(2), nullptr);
}

}  // namespace
}  // namespace hpm
