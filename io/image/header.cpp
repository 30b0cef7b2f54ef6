#include "io/image/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/inflate.h"
#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::int64_t> wholeNumbers(const std::string& file, const std::string& key,
                                       const std::string& text) {
    std::vector<std::int64_t> result;
    std::istringstream stream(text);
    for (std::string word; stream >> word;) {
        std::int64_t value = 0;
        const char *begin = word.data() + (word[0] == '+'), *end = word.data() + word.size();
        const auto parsed = std::from_chars(begin, end, value);
        // 99999999999999999999 is whole, and fits nothing.
        if (parsed.ptr != end || parsed.ec != std::errc())
            throw InputError(file,
                             fmt::format("'{}' says '{}'; expected whole numbers{}", key, oneLine(text),
                                         parsed.ec == std::errc::result_out_of_range ? " below 2^63" : ""));
        result.push_back(value);
    }
    return result;
}

std::vector<double> numbers(const std::string& text) {
    std::vector<double> result;
    const char* at = text.c_str();
    for (char* end = nullptr;; at = end) {
        const double value = std::strtod(at, &end);
        if (end == at) return result;
        result.push_back(value);
    }
}

bool isGzip(const fs::path& path) {
    unsigned char magic[2] = {};
    std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(magic), 2);
    return magic[0] == 0x1F && magic[1] == 0x8B;
}

namespace {

struct FileStart {
    std::string text;
    std::string
        complaint;  // of a gzip stream that goes no further: "it breaks off", "invalid distance too far back"
};

// All that comes before a damaged place, of one gzip stream or of several after one another.
FileStart inflatedStart(std::ifstream& file, std::size_t count) {
    FileStart start;
    std::vector<char> in(1 << 14), out(1 << 14);
    InflateStream stream;
    bool ended = false;
    while (start.text.size() < count) {
        file.read(in.data(), static_cast<std::streamsize>(in.size()));
        std::string_view left(in.data(), static_cast<std::size_t>(file.gcount()));
        if (left.empty()) break;
        for (bool full = false; (!left.empty() || full) && start.text.size() < count;) {
            if (ended) stream.restart();
            std::span<char> room(out.data(), std::min(out.size(), count - start.text.size()));
            const std::size_t offered = room.size();
            const InflateStream::State state = stream.inflate(left, room);
            const std::size_t came = offered - room.size();
            start.text.append(out.data(), came);
            full = room.empty();
            if (state == InflateStream::State::damaged) {
                if (!ended || came > 0) start.complaint = "is damaged (" + stream.complaint() + ")";
                return start;  // or padding behind the end
            }
            ended = state == InflateStream::State::ended;
        }
    }
    if (start.text.size() < count && !ended) start.complaint = "breaks off (the file is truncated)";
    return start;
}

FileStart startOf(const fs::path& path, std::size_t count) {
    std::ifstream file(path, std::ios::binary);
    if (isGzip(path)) return inflatedStart(file, count);
    FileStart start;
    start.text.resize(count);
    file.read(start.text.data(), static_cast<std::streamsize>(count));
    start.text.resize(static_cast<std::size_t>(file.gcount()));
    return start;
}

}  // namespace

std::string firstBytes(const fs::path& path, std::size_t count) { return startOf(path, count).text; }

void checkGzipStart(const fs::path& path) {
    constexpr std::size_t kHeader = 1024;  // the longest header of fixed length, MRC's
    if (!isGzip(path)) return;
    const FileStart start = startOf(path, kHeader);
    if (!start.complaint.empty())
        throw InputError(path.string(),
                         fmt::format("its gzip stream {} after {} bytes; copy or download it again",
                                     start.complaint, start.text.size()));
    if (isowave::isGzip(std::string_view(start.text)))
        throw InputError(path.string(), "is compressed by gzip twice; gunzip it once");
}

std::string headerFileText(const fs::path& path) { return firstBytes(path, kLongestHeader); }

namespace {

// How far a zlib or gzip stream (or several gzip ones after another) inflates; finished: its end mark and
// checksum were there and right.
struct Inflated {
    std::int64_t bytes = 0;
    bool finished = false;
};

Inflated measured(std::ifstream& file) {
    std::vector<char> in(1 << 16), out(1 << 18);
    InflateStream stream;
    Inflated result;
    bool ended = false;
    while (file.read(in.data(), static_cast<std::streamsize>(in.size())) || file.gcount() > 0) {
        std::string_view left(in.data(), static_cast<std::size_t>(file.gcount()));
        for (bool full = false; !left.empty() || full;) {
            if (ended) stream.restart();
            std::span<char> room(out);
            const InflateStream::State state = stream.inflate(left, room);
            // Bytes behind the end that are no further stream are padding.
            if (state == InflateStream::State::damaged) return result;
            const std::size_t came = out.size() - room.size();
            result.bytes += static_cast<std::int64_t>(came);
            full = room.empty();
            ended = state == InflateStream::State::ended;
            if (ended || came > 0) result.finished = ended;
        }
    }
    return result;
}

// The last 4 bytes of a gzip stream are its length modulo 2^32. If they say what is needed, the file is whole
// but for a chance of 2^-32, and a large file need not be inflated twice.
bool gzipEndsAt(const fs::path& path, std::int64_t bytes) {
    const auto length = static_cast<std::streamoff>(fs::file_size(path));
    if (length < 18) return false;
    std::ifstream file(path, std::ios::binary);
    file.seekg(length - 4);
    unsigned char end[4] = {};
    file.read(reinterpret_cast<char*>(end), 4);
    const std::uint32_t says = end[0] | end[1] << 8 | end[2] << 16 | static_cast<std::uint32_t>(end[3]) << 24;
    return says == static_cast<std::uint32_t>(bytes);
}

[[noreturn]] void throwTruncated(const fs::path& path, const std::string& promise, std::int64_t needed,
                                 std::int64_t held) {
    std::string wanted = bytesText(static_cast<double>(needed)), found = bytesText(static_cast<double>(held));
    if (needed == held)
        found = "no end of its compressed data";
    else if (wanted == found)
        wanted = fmt::format("{} bytes", needed), found = fmt::format("{}", held);
    throw InputError(path.string(),
                     fmt::format("{} ({}) but the file holds {}; it is truncated or its header is wrong",
                                 promise, wanted, found));
}

}  // namespace

void checkPlain(const fs::path& path, std::int64_t start, std::int64_t needed, const std::string& promise) {
    const std::int64_t held = static_cast<std::int64_t>(fs::file_size(path)) - start;
    if (held < needed) throwTruncated(path, promise, needed, std::max<std::int64_t>(held, 0));
}

void checkDeflated(const fs::path& path, std::int64_t start, std::int64_t needed,
                   const std::string& promise) {
    const std::int64_t packed = static_cast<std::int64_t>(fs::file_size(path)) - start;
    if (needed / static_cast<std::int64_t>(kBestDeflateRatio) > packed)
        throw InputError(path.string(),
                         fmt::format("{} ({}) but the file holds {} compressed, too few for that; it is "
                                     "truncated or its header is wrong",
                                     promise, bytesText(static_cast<double>(needed)),
                                     bytesText(static_cast<double>(std::max<std::int64_t>(packed, 0)))));
    if (gzipEndsAt(path, needed)) return;
    std::ifstream file(path, std::ios::binary);
    file.seekg(start);
    const Inflated inflated = measured(file);
    if (inflated.bytes < needed || !inflated.finished)
        throwTruncated(path, promise, needed, std::min(inflated.bytes, needed));
}

namespace {

// A pattern with its number: %d, %03d, %5i. Nothing else may stand behind the %.
std::string withNumber(const std::string& file, const std::string& pattern, std::int64_t number) {
    const std::size_t percent = pattern.find('%');
    const std::size_t letter = pattern.find_first_not_of("0123456789", percent + 1);
    const bool good = letter != std::string::npos && std::strchr("diu", pattern[letter]) &&
                      letter - percent <= 3 && pattern.find('%', letter) == std::string::npos;
    if (!good)
        throw InputError(file,
                         fmt::format("'{}' should name its files of voxels; expected one number such as "
                                     "%03d in it",
                                     oneLine(pattern)));
    const std::string width = pattern.substr(percent + 1, letter - percent - 1);
    std::string digits = std::to_string(number);
    const std::size_t least = width.empty() ? 0 : static_cast<std::size_t>(std::stoi(width));
    if (digits.size() < least) digits.insert(0, least - digits.size(), width[0] == '0' ? '0' : ' ');
    return pattern.substr(0, percent) + digits + pattern.substr(letter + 1);
}

std::optional<std::int64_t> wholeNumber(const std::string& word) {
    std::int64_t value = 0;
    const char* end = word.data() + word.size();
    const auto parsed = std::from_chars(word.data(), end, value);
    return parsed.ptr == end && parsed.ec == std::errc() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::vector<std::string> numberedNames(const std::string& file, const std::string& text,
                                       std::optional<std::int64_t> count) {
    constexpr std::int64_t kMost = 1'000'000;
    std::string pattern = trimmed(text);
    std::vector<std::int64_t> range;
    for (std::size_t blank; (blank = pattern.find_last_of(" \t")) != std::string::npos;) {
        const auto value = wholeNumber(pattern.substr(blank + 1));
        if (!value) break;
        range.insert(range.begin(), *value);
        pattern = trimmed(pattern.substr(0, blank));
    }
    if (range.empty() && count) range = {1, *count};
    const std::int64_t step = range.size() > 2 ? range[2] : 1;
    const bool good =
        range.size() >= 2 && step > 0 && range[0] >= 0 && range[0] <= range[1] && range[1] < kMost * step;
    if (!good)
        throw InputError(file,
                         fmt::format("'{}' should name its files of voxels; expected a pattern, the first "
                                     "number and the last",
                                     oneLine(text)));
    std::vector<std::string> names;
    for (std::int64_t n = range[0]; n <= range[1]; n += step) names.push_back(withNumber(file, pattern, n));
    return names;
}

void requireFile(const fs::path& header, const fs::path& data) {
    std::error_code error;
    if (!fs::is_regular_file(data, error))
        throw InputError(header.string(),
                         fmt::format("its voxels should be in {}, which is missing; put it beside the "
                                     "header",
                                     data.string()));
}

std::string sizesText(const std::vector<std::int64_t>& size) {
    std::string text;
    for (const std::int64_t n : size) text += (text.empty() ? "" : " x ") + std::to_string(n);
    return text;
}

std::optional<std::array<double, 3>> badAmong(const std::vector<double>& spacing, bool nanIsUnknown) {
    std::array<double, 3> first{1, 1, 1};
    bool bad = false;
    for (std::size_t a = 0; a < std::min<std::size_t>(3, spacing.size()); ++a) {
        first[a] = spacing[a];
        if (nanIsUnknown && std::isnan(spacing[a])) continue;
        bad = bad || !(spacing[a] > 0) || !std::isfinite(spacing[a]);
    }
    return bad ? std::optional(first) : std::nullopt;
}

}  // namespace isowave::imageio
