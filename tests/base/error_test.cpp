#include "isowave/error.h"

#include <gtest/gtest.h>

namespace isowave {
namespace {

TEST(Messages, AreOneLineWhateverPieceOfAFileTheyShow) {
    EXPECT_STREQ(InputError("a.off", "'3\n\x1b[2J\x7f' is no number").what(),
                 "a.off: '3??[2J?' is no number");
    EXPECT_STREQ(InputError(std::string("a\tb")).what(), "a?b");
    EXPECT_STREQ(UsageError("'\r' is not a number").what(), "'?' is not a number");
    EXPECT_STREQ(OperationError("a", "\v").what(), "a: ?");
}

TEST(Messages, KeepLettersBeyondAscii) {
    EXPECT_STREQ(InputError("Schädel.nrrd", "ist leer").what(), "Schädel.nrrd: ist leer");
}

TEST(Messages, OfEndlessTextsAreCut) {
    const std::string text = InputError("a", std::string(1'000'000, 'x')).what();
    EXPECT_EQ(text.size(), kLongestMessage + 3);
    EXPECT_TRUE(text.ends_with("x..."));
    EXPECT_EQ(std::string(InputError(std::string(kLongestMessage, 'x')).what()).back(), 'x');
}

}  // namespace
}  // namespace isowave
