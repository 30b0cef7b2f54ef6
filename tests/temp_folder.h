// Where tests write.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace isowave::test {

// An empty folder of this process and test alone, gone when the object goes: runs at the same time, of other
// builds or users, do not meet. name: tells folders of one test apart.
class TempFolder {
  public:
    explicit TempFolder(const std::string& name = "") {
        std::string full = "isowave_";
        if (const auto* info = ::testing::UnitTest::GetInstance()->current_test_info())
            full += std::string(info->test_suite_name()) + "." + info->name() + "_";
        full += name + "_" + std::to_string(::getpid());
        std::replace(full.begin(), full.end(), '/', '_');
        path_ = std::filesystem::temp_directory_path() / full;
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TempFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

}  // namespace isowave::test
