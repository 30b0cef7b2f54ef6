#include "base/links.h"

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr int kMostLinks = 40;  // in a row, as Linux follows them

}  // namespace

std::filesystem::path behindLinks(const std::filesystem::path& place) {
    std::filesystem::path result = place;
    std::error_code error;
    for (int links = 0; std::filesystem::is_symlink(result, error); ++links) {
        if (links == kMostLinks) throw OperationError(place.string(), "is a link that leads to itself");
        // An absolute target takes the place of the folder, too.
        result = result.parent_path() / std::filesystem::read_symlink(result, error);
    }
    return result;
}

}  // namespace isowave
