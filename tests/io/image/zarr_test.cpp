// Zarr, version 2: stores as python3-zarr writes them, and damaged ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/image/stream.h"
#include "isowave/error.h"
#include "isowave/image.h"
#include "temp_folder.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string bytesOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void put(const fs::path& path, const std::string& bytes) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
}

std::string refusal(const fs::path& path, const ImageReadOptions& options = {}) {
    try {
        readImage(path, options);
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    } catch (const UsageError& error) {
        return std::string("usage: ") + error.what();
    }
    return "";
}

// A store of 2 x 3 x 4 voxels (z, y, x), whose values count from 0, in two chunks of uint8 without a codec.
json smallArray() {
    return {{"zarr_format", 2},      {"shape", {2, 3, 4}}, {"chunks", {1, 3, 4}}, {"dtype", "|u1"},
            {"compressor", nullptr}, {"fill_value", 0},    {"order", "C"},        {"filters", nullptr}};
}
void putSmall(const fs::path& folder, const json& array = smallArray()) {
    put(folder / ".zarray", array.dump());
    std::string low, high;
    for (char i = 0; i < 12; ++i) low += i, high += static_cast<char>(i + 12);
    put(folder / "0.0.0", low);
    put(folder / "1.0.0", high);
}

// ---- what python3-zarr writes

TEST(Zarr, IsReadAsItsOwnLibraryReadsIt) {
    const test::TempFolder folder;
    const std::string command = "/usr/bin/python3 " ISOWAVE_SOURCE_DIR "/tests/io/image/zarr_stores.py " +
                                folder.path().string() + " > " + (folder / "said").string();
    ASSERT_EQ(std::system(command.c_str()), 0);
    if (bytesOf(folder / "said") != "zarr\n") GTEST_SKIP() << "Python has no zarr; scripts/setup installs it";
    const json entries = json::parse(bytesOf(folder / "list.json"));
    EXPECT_GT(entries.size(), 60u);
    for (const json& entry : entries) {
        const auto name = entry["name"].get<std::string>();
        SCOPED_TRACE(name);
        ImageReadOptions options;
        if (entry["options"].contains("time")) options.time = entry["options"]["time"];
        if (entry["options"].contains("channel")) options.channel = entry["options"]["channel"];
        const fs::path path = folder.path() / entry["path"].get<std::string>();
        const Image image = readImage(path, options);
        EXPECT_EQ(json(image.size), entry["size"]);
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t row = 0; row < 3; ++row) {
                const double wanted = a == row ? entry["spacing"][a].get<double>() : 0;
                EXPECT_NEAR(image.indexToWorld.axis[a][row], wanted, 1e-12);
            }
            EXPECT_NEAR(image.indexToWorld.origin[a], entry["origin"][a].get<double>(), 1e-12);
        }
        EXPECT_EQ(image.space, Space::unspecified);
        const std::string raw = bytesOf(folder / (name + ".raw"));
        ASSERT_EQ(raw.size(), image.values.size() * sizeof(float));
        EXPECT_EQ(std::memcmp(raw.data(), image.values.data(), raw.size()), 0);
        const auto remark = entry["remark"].get<std::string>();
        if (!remark.empty()) {
            EXPECT_THAT(image.warnings, Contains(HasSubstr(remark)));
        }
    }
}

TEST(Zarr, StreamedIsTheSame) {
    const test::TempFolder folder;
    putSmall(folder / "a.zarr");
    ImageStream stream(folder / "a.zarr");
    std::vector<float> values(24, -1);
    stream.pass("reading", {}, [&](const Slab& slab) {
        const auto voxels = std::get<std::span<const std::uint8_t>>(slab.voxels);
        std::copy(voxels.begin(), voxels.end(), values.begin() + 12 * slab.z0);
    });
    for (int i = 0; i < 24; ++i) EXPECT_EQ(values[static_cast<std::size_t>(i)], i);
}

TEST(Zarr, WithoutAPlaceHasVoxelsOfOneAndSaysSo) {
    const test::TempFolder folder;
    putSmall(folder / "a.zarr");
    const Image image = readImage(folder / "a.zarr");
    EXPECT_THAT(image.spacing(), ElementsAre(1, 1, 1));
    EXPECT_EQ(image.format, "Zarr");
    EXPECT_THAT(image.warnings, AllOf(Contains(HasSubstr("1 x 1 x 1 mm")), Contains(HasSubstr("z, y, x"))));
    EXPECT_THAT(readImage(folder / "a.zarr", {.spacing = {{0.5, 1, 2}}}).spacing(), ElementsAre(0.5, 1, 2));
}

TEST(Zarr, OfSeveralResolutionsSaysWhichIsRead) {
    const test::TempFolder folder;
    for (const char* part : {"0", "1"}) putSmall(folder / (std::string("a.zarr/") + part));
    put(folder / "a.zarr/.zgroup", R"({"zarr_format": 2})");
    put(folder / "a.zarr/.zattrs",
        R"({"multiscales": [{"axes": ["z", "y", "x"], "datasets": [{"path": "0"}, {"path": "1"}]}]})");
    EXPECT_THAT(readImage(folder / "a.zarr").warnings,
                Contains(HasSubstr("resolution 0 is read; there are also 1: give")));
}

// ---- what is refused

TEST(Zarr, DamagedChunksAreNamed) {
    const test::TempFolder folder;
    const json codecs[] = {
        {{"id", "zlib"}}, {{"id", "gzip"}}, {{"id", "blosc"}}, {{"id", "zstd"}}, {{"id", "lz4"}}};
    for (const json& codec : codecs) {
        const fs::path store = folder / (codec["id"].get<std::string>() + ".zarr");
        json array = smallArray();
        array["compressor"] = codec;
        putSmall(store, array);  // whose bytes are none of the codec's
        EXPECT_THAT(refusal(store), AnyOf(HasSubstr("0.0.0"), HasSubstr("1.0.0"))) << codec;
    }
    putSmall(folder / "short.zarr");
    fs::resize_file(folder / "short.zarr/1.0.0", 11);
    EXPECT_THAT(refusal(folder / "short.zarr"),
                AllOf(HasSubstr("1.0.0"), HasSubstr("holds 11 bytes"), HasSubstr("has 12")));
    fs::resize_file(folder / "short.zarr/1.0.0", 0);
    EXPECT_THAT(refusal(folder / "short.zarr"), HasSubstr("holds 0 bytes"));
    fs::resize_file(folder / "short.zarr/1.0.0", 1 << 20);
    EXPECT_THAT(refusal(folder / "short.zarr"), HasSubstr("of another array"));
}

// Every shorter file and every changed byte is read as something or refused in a line.
TEST(Zarr, NoDamageOfPackedChunksEndsTheProgram) {
    const test::TempFolder folder;
    const std::string command = "/usr/bin/python3 " ISOWAVE_SOURCE_DIR "/tests/io/image/zarr_stores.py " +
                                folder.path().string() + " > " + (folder / "said").string();
    ASSERT_EQ(std::system(command.c_str()), 0);
    if (bytesOf(folder / "said") != "zarr\n") GTEST_SKIP() << "Python has no zarr; scripts/setup installs it";
    for (const char* name :
         {"zlib-C", "gzip-C", "zstd-C", "lz4-C", "blosc-blosclz-1-C", "blosc-lz4-2-F", "blosc-zstd-1-C"}) {
        SCOPED_TRACE(name);
        const fs::path chunk = folder / name / "1.1.1";
        const std::string good = bytesOf(chunk);
        ASSERT_GT(good.size(), 20u);
        int refused = 0;
        for (std::size_t n = 0; n < good.size(); ++n) {
            put(chunk, good.substr(0, n));
            refused += refusal(folder / name) != "";
            std::string bad = good;
            bad[n] = static_cast<char>(bad[n] ^ 0x55);
            put(chunk, bad);
            refusal(folder / name);
        }
        // zlib's and gzip's last bytes are checksums; a blosc frame says how long it is.
        EXPECT_EQ(refused, static_cast<int>(good.size()));
        put(chunk, good);
        EXPECT_EQ(refusal(folder / name), "");
    }
}

TEST(Zarr, NoTruncationOfItsMetadataIsTakenForAnArray) {
    const test::TempFolder folder;
    putSmall(folder / "a.zarr");
    const std::string whole = bytesOf(folder / "a.zarr/.zarray");
    for (std::size_t n = 0; n < whole.size(); ++n) {
        put(folder / "a.zarr/.zarray", whole.substr(0, n));
        EXPECT_THAT(refusal(folder / "a.zarr"), HasSubstr(".zarray")) << n;
    }
}

TEST(Zarr, WrongKeysAreNamedWithWhatWasExpected) {
    const test::TempFolder folder;
    const std::pair<const char*, json> wrong[] = {{"zarr_format", 3},
                                                  {"shape", {2, 3}},
                                                  {"shape", {0, 3, 4}},
                                                  {"shape", "2"},
                                                  {"shape", {2, -3, 4}},
                                                  {"chunks", {1, 3}},
                                                  {"chunks", {1, 3, 0}},
                                                  {"dtype", "<f2"},
                                                  {"dtype", "<c8"},
                                                  {"dtype", "u1"},
                                                  {"dtype", json::array()},
                                                  {"compressor", {{"id", "bz2"}}},
                                                  {"compressor", "zlib"},
                                                  {"order", "A"},
                                                  {"filters", {{{"id", "delta"}}}},
                                                  {"fill_value", "x"},
                                                  {"fill_value", 256},
                                                  {"fill_value", "NaN"},
                                                  {"dimension_separator", "-"},
                                                  {"chunks", {1 << 30, 1 << 30, 1}}};
    for (const auto& [key, value] : wrong) {
        json array = smallArray();
        array[key] = value;
        putSmall(folder / "a.zarr", array);
        EXPECT_NE(refusal(folder / "a.zarr"), "") << key << ' ' << value;
    }
}

// A shape is a few bytes, and the chunks that it promises may be more than can be looked for.
TEST(Zarr, AShapeOfAnySizeIsAnsweredAtOnce) {
    const test::TempFolder folder;
    json array = smallArray();
    array["chunks"] = {1, 1, 1};
    const std::int64_t most = std::int64_t{1} << 40, many = 1 << 20;
    array["shape"] = {most, most, most};
    putSmall(folder / "a.zarr", array);
    EXPECT_THAT(refusal(folder / "a.zarr"), HasSubstr("more than can be addressed"));
    array["shape"] = {many, many, many};
    putSmall(folder / "a.zarr", array);
    EXPECT_THAT(refusal(folder / "a.zarr"), HasSubstr("more than the limit"));
    fs::remove(folder / "a.zarr/0.0.0");
    fs::remove(folder / "a.zarr/1.0.0");
    EXPECT_THAT(refusal(folder / "a.zarr"), HasSubstr("none of its 1152921504606846976 chunks"));
}

// Names that only look like one of a chunk: of another image, beyond the shape, not as numbers are written.
TEST(Zarr, CountsTheChunksOfItsVolumeAlone) {
    const test::TempFolder folder;
    for (const std::string separator : {".", "/"}) {
        const fs::path store = folder / (separator == "/" ? "nested.zarr" : "flat.zarr");
        json array = smallArray();
        array["shape"] = {2, 3, 3, 4};
        array["chunks"] = {1, 1, 3, 4};
        array["fill_value"] = 7;
        array["dimension_separator"] = separator;
        put(store / ".zarray", array.dump());
        put(store / ".zattrs", R"({"_ARRAY_DIMENSIONS": ["t", "z", "y", "x"]})");
        for (const char* at : {"0000", "0200", "1100", "1300", "2000", "1010", "100", "10000"}) {
            std::string name;
            for (const char* digit = at; *digit; ++digit) name += (name.empty() ? "" : separator) + *digit;
            if (separator == "." || std::strlen(at) == 4) put(store / name, std::string(12, 'a'));
        }
        put(store / (separator == "/" ? "1/02/0/0" : "1.02.0.0"), std::string(12, 'a'));
        const Image image = readImage(store, {.time = 2});
        EXPECT_THAT(image.warnings, Contains(HasSubstr("2 of 3 chunks are not there"))) << separator;
        EXPECT_EQ(image.values[0], 7);
        EXPECT_EQ(image.values[12], 'a');
        EXPECT_THAT(readImage(store, {.time = 1}).warnings, Contains(HasSubstr("1 of 3 chunks are not")));
    }
}

TEST(Zarr, OtherVersionsAndGroupsSayWhatToDo) {
    const test::TempFolder folder;
    put(folder / "three.zarr/zarr.json", R"({"zarr_format": 3})");
    EXPECT_THAT(refusal(folder / "three.zarr"), AllOf(HasSubstr("version 3"), HasSubstr("zarr_format=2")));
    put(folder / "group.zarr/.zgroup", R"({"zarr_format": 2})");
    EXPECT_THAT(refusal(folder / "group.zarr"), HasSubstr("without arrays"));
    putSmall(folder / "group.zarr/3");
    EXPECT_THAT(refusal(folder / "group.zarr"), AllOf(HasSubstr("choose one"), HasSubstr("group.zarr/3")));
    put(folder / "file.zarr", "PK");
    EXPECT_THAT(refusal(folder / "file.zarr"), HasSubstr("is a folder"));
    putSmall(folder / "empty.zarr");
    fs::remove(folder / "empty.zarr/0.0.0");
    fs::remove(folder / "empty.zarr/1.0.0");
    EXPECT_THAT(refusal(folder / "empty.zarr"), HasSubstr("none of its 2 chunks"));
}

std::string withAttributes(const fs::path& store, const std::string& attributes,
                           const ImageReadOptions& options = {}) {
    putSmall(store / "0");
    put(store / ".zgroup", R"({"zarr_format": 2})");
    put(store / ".zattrs", attributes);
    return refusal(store, options);
}

TEST(Zarr, AttributesThatMakeNoSenseAreRefused) {
    const test::TempFolder folder;
    const fs::path store = folder / "a.zarr";
    const auto with = [](const std::string& axes, const std::string& transforms) {
        return R"({"multiscales": [{"axes": )" + axes +
               R"(, "datasets": [{"path": "0", "coordinateTransformations": )" + transforms + "}]}]}";
    };
    const std::string zyx = R"(["z", "y", "x"])";
    EXPECT_EQ(withAttributes(store, with(zyx, R"([{"type": "scale", "scale": [1, 2, 3]}])")), "");
    const std::pair<std::string, const char*> wrong[] = {
        {with(zyx, R"([{"type": "scale", "scale": [1, 2]}])"), "expected 3 numbers"},
        {with(zyx, R"([{"type": "scale", "scale": [1, 2, "3"]}])"), "expected 3 numbers"},
        {with(zyx, R"([{"type": "affine", "affine": [1]}])"), "expected scale or translation"},
        {with(zyx, R"([{"type": "scale", "scale": [1, 0, 3]}])"), "scale along y is 0"},
        {with(R"(["z", "y", "y"])", "[]"), "two axes y"},
        {with(R"(["z", "y", "q"])", "[]"), "none of x, y, z"},
        {with(R"(["z", "y"])", "[]"), "2 are named"},
        {with(R"([{"name": "z", "unit": "parsec"}, "y", "x"])", "[]"), "no length"},
        {with(R"(["t", "y", "x"])", "[]"), "holds 2 times; choose one with --time, 1 to 2"},
        {R"({"multiscales": [{"datasets": []}]})", "no datasets"},
        {R"({"multiscales": [{"datasets": [{"path": "../other/0"}]}]})", "not in the store"},
        {R"({"multiscales": [{"datasets": [{"path": "/etc"}]}]})", "not in the store"},
        {R"({"multiscales": [{"axes": 3, "datasets": [{"path": "0"}]}]})", "expected a list"},
        {R"({"multiscales": [{"datasets": [{"path": "7"}]}]})", "7/.zarray"},
        {"{", "no JSON"}};
    for (const auto& [attributes, text] : wrong)
        EXPECT_THAT(withAttributes(store, attributes), HasSubstr(text)) << attributes;
    EXPECT_THAT(withAttributes(store, with(R"(["t", "y", "x"])", "[]"), {.time = 3}),
                HasSubstr("--time says 3"));
    EXPECT_THAT(withAttributes(store, with(zyx, "[]"), {.channel = 1}), HasSubstr("no axis of channels"));
    EXPECT_THAT(withAttributes(store, with(R"(["t", "y", "x"])", "[]"), {.time = 1}), HasSubstr("2D image"));
}

}  // namespace
}  // namespace isowave
