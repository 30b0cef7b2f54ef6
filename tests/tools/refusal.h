// That the program refuses: in one line, and leaving everything as it was.
#pragma once

#include <gmock/gmock.h>

#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {

inline void expectRefused(const Folder& folder, const std::vector<std::string>& arguments, int exitCode,
                          const std::string& text) {
    const auto before = folder.snapshot();
    const Result result = isowave(arguments);
    EXPECT_EQ(result.exitCode, exitCode) << text;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_THAT(result.err, ::testing::HasSubstr(text));
    EXPECT_EQ(folder.snapshot(), before) << text;
}

}  // namespace isowave::tools_test
