#include "base/inflate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "gzip.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using test::gzipped;
using testing::HasSubstr;

constexpr std::size_t kAny = std::size_t{1} << 40;

// Letters at random: some 2 to 1.
std::string letters(std::size_t count) {
    std::mt19937 random(7);
    std::string text(count, 'a');
    for (char& c : text) c = static_cast<char>('a' + random() % 8);
    return text;
}

std::string refusal(const std::string& packed, std::size_t most = kAny) {
    try {
        gunzipped(packed, "a.gz", most);
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(Gunzipped, GivesEveryByteBack) {
    for (const std::size_t count : {0, 1, 17, 65'535, 65'536, 65'537, 3'000'000}) {
        const std::string text = letters(count);
        EXPECT_TRUE(gunzipped(gzipped(text), "a.gz", kAny) == text) << count;
    }
    // Beyond the ratio at which the length that a file says is believed.
    const std::string even(5'000'000, 'x');
    EXPECT_TRUE(gunzipped(gzipped(even), "a.gz", kAny) == even);
}

TEST(Gunzipped, JoinsStreamsAndLeavesOutZerosBehindThem) {
    const std::string two = gzipped(letters(100'000)) + gzipped("tail");
    EXPECT_TRUE(gunzipped(two, "a.gz", kAny) == letters(100'000) + "tail");
    EXPECT_TRUE(gunzipped(two + std::string(512, '\0'), "a.gz", kAny) == letters(100'000) + "tail");
    EXPECT_THAT(refusal(two + "more"), HasSubstr("4 bytes behind the end of its gzip stream"));
}

TEST(Gunzipped, RefusesEveryTruncation) {
    const std::string packed = gzipped(letters(500));
    for (std::size_t length = 2; length < packed.size(); ++length)
        EXPECT_THAT(refusal(packed.substr(0, length)), HasSubstr("it is truncated")) << length;
}

// Of the header, bytes 3 to 9 are flags, a time and a system, which say nothing of the data.
TEST(Gunzipped, RefusesEveryDamagedByteOfTheData) {
    const std::string packed = gzipped(letters(500));
    for (std::size_t at = 10; at < packed.size(); ++at) {
        std::string damaged = packed;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        EXPECT_THAT(refusal(damaged), HasSubstr("a.gz: its gzip stream ")) << at;
    }
}

TEST(Gunzipped, RefusesWhatTheMemoryHasNoRoomFor) {
    const std::string packed = gzipped(letters(200'000));
    EXPECT_EQ(refusal(packed, 200'000), "");
    EXPECT_THAT(refusal(packed, 199'999), HasSubstr("the limit of memory"));
    EXPECT_THAT(refusal(packed, 1000), HasSubstr("inflates to more than 1 kB"));
}

// 384 MiB of zeros in 0.4 MB.
TEST(Gunzipped, RefusesABombBelowTheLimitOfMemory) {
    const std::string piece = gzipped(std::string(std::size_t{1} << 24, '\0'));
    std::string bomb;
    for (int i = 0; i < 24; ++i) bomb += piece;
    EXPECT_THAT(refusal(bomb), HasSubstr("250 times as much"));
}

TEST(InflateStream, TakesAndGivesPiecesOfAnySize) {
    const std::string text = letters(5000), packed = gzipped(text);
    for (const std::size_t piece : {1, 3, 1000}) {
        InflateStream stream;
        std::string out;
        auto state = InflateStream::State::going;
        for (std::size_t at = 0; at < packed.size(); at += piece) {
            std::string_view in = std::string_view(packed).substr(at, piece);
            for (bool more = true; more;) {
                char block[7];
                std::span<char> room(block);
                state = stream.inflate(in, room);
                out.append(block, sizeof block - room.size());
                more = state == InflateStream::State::going && room.empty();
            }
        }
        EXPECT_EQ(state, InflateStream::State::ended);
        EXPECT_TRUE(out == text) << piece;
    }
}

TEST(WithoutGz, TakesOneExtensionOffInAnyCase) {
    EXPECT_EQ(withoutGz("a/part.stl.gz"), "a/part.stl");
    EXPECT_EQ(withoutGz("part.STL.GZ"), "part.STL");
    EXPECT_EQ(withoutGz("part.stl"), "part.stl");
    EXPECT_EQ(withoutGz("a.gz/part"), "a.gz/part");
}

}  // namespace
}  // namespace isowave
