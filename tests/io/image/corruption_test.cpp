// Files that were changed at random places: the image is read or refused in one line. Nothing is printed and nothing
// aborts, which ITK, VNL and the libraries below them do over a wrong number; no case takes 5 s or 1 GB.
//
// Each case is read in a child process, many to a child; where a child dies the next one goes on behind the
// case that killed it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cstring>
#include <random>
#include <set>

#include "gzip.h"
#include "isowave/image.h"
#include "tests/io/image/dicom_writer.h"
#include "tests/io/image/files.h"
#include "tests/io/image/itk.h"
#include "tests/io/image/written.h"
#include "volume/linear_transform.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using test::bytesOf;
using test::gzipped;
using test::put;

struct Mutation {
    std::string what;   // "byte 17 = 255"
    std::string bytes;  // of the whole file
};

// ---- reading in a child

// What the child tells its parent, in memory that both see.
struct Shared {
    std::size_t next = 0;  // the case after the one at work
    std::size_t read = 0, refused = 0;
    char complaint[300] = {};  // of the case at work, when it broke a promise without dying
};

// 64 MB and 5 s are plenty for a few hundred voxels.
constexpr std::int64_t kMemory = std::int64_t(64) << 20;
constexpr unsigned kSeconds = 5;

// One case; returns what is wrong with how it went.
std::string readOne(const fs::path& image, Shared& shared) {
    try {
        ImageReadOptions options;
        options.memoryLimit = kMemory;
        const Image read = readImage(image, options);
        ++shared.read;
        if (read.voxelCount() != static_cast<std::int64_t>(read.values.size())) return "voxels are missing";
        for (int a = 0; a < 3; ++a)
            for (const double x : {read.indexToWorld.origin[a], read.indexToWorld.axis[0][a],
                                   read.indexToWorld.axis[1][a], read.indexToWorld.axis[2][a]})
                if (!std::isfinite(x)) return "a transform that is not finite";
        for (const double s : read.spacing())
            if (!(s > 0)) return fmt::format("a spacing of {}", s);
        linearTransform(read.indexToWorld, image.string());
        return "";
    } catch (const InputError& e) {
        ++shared.refused;
        const std::string text = e.what();
        if (text.find('\n') != text.npos) return "several lines: " + text;
        // The path and something behind it.
        return text.size() > image.string().size() + 5 ? "" : "says nothing: " + text;
    } catch (const std::exception& e) {
        return std::string("another exception: ") + e.what();
    }
}

[[noreturn]] void child(const fs::path& file, const fs::path& image, const std::vector<Mutation>& mutations,
                        Shared& shared) {
    while (shared.next < mutations.size()) {
        const Mutation& mutation = mutations[shared.next];
        const off_t printedBefore = ::lseek(STDOUT_FILENO, 0, SEEK_END);
        put(file, mutation.bytes);
        ::alarm(kSeconds);
        std::string wrong = readOne(image, shared);
        std::cout.flush();
        std::fflush(nullptr);
        ::alarm(0);
        if (::lseek(STDOUT_FILENO, 0, SEEK_END) > printedBefore && wrong.empty())
            wrong = "something was printed";
        ++shared.next;
        if (wrong.empty()) continue;
        std::strncpy(shared.complaint, wrong.c_str(), sizeof shared.complaint - 1);
        ::_exit(1);
    }
    ::_exit(0);
}

class Corruption : public test::ImageFiles {
  protected:
    // file: is replaced by each mutation; image: what is then read (the file itself or its header).
    void sweep(const fs::path& file, const fs::path& image, const std::vector<Mutation>& mutations) {
        SCOPED_TRACE(file.filename().string());
        void* memory =
            ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        ASSERT_NE(memory, MAP_FAILED);
        auto& shared = *new (memory) Shared;
        const fs::path printed = folder / "printed";
        while (shared.next < mutations.size()) {
            shared.complaint[0] = 0;
            std::fflush(nullptr);
            const pid_t pid = ::fork();
            if (pid == 0) {
                for (const int stream : {1, 2}) {
                    if (!std::freopen(printed.c_str(), "ab", stream == 1 ? stdout : stderr)) ::_exit(2);
                }
                child(file, image, mutations, shared);
            }
            int status = 0;
            rusage used{};
            ::wait4(pid, &status, 0, &used);
            EXPECT_LT(used.ru_maxrss, 1 << 20) << "kB";
            if (WIFSIGNALED(status)) {
                ADD_FAILURE() << mutations[shared.next].what << ": killed by signal " << WTERMSIG(status);
                ++shared.next;
            } else if (WEXITSTATUS(status) != 0) {
                ADD_FAILURE() << mutations[shared.next - 1].what << ": " << shared.complaint;
            }
        }
        EXPECT_EQ(bytesOf(printed).substr(0, 500), "");
        std::printf("%s: %zu read, %zu refused\n", file.filename().c_str(), shared.read, shared.refused);
        // Most of them are noticed, and not everything is.
        EXPECT_GT(shared.refused, mutations.size() / 10);
        EXPECT_GT(shared.read, 0u);
        ::munmap(memory, sizeof(Shared));
        fs::remove(printed);
    }
};

// ---- mutations

std::string replaced(std::string bytes, std::size_t at, std::size_t count, const std::string& by) {
    return bytes.replace(at, count, by);
}

// Every byte of the header by each of a few, and with one bit turned.
void changeBytes(const std::string& bytes, std::size_t header, std::vector<Mutation>& mutations) {
    for (std::size_t at = 0; at < header; ++at) {
        std::set<char> values{'\0', '\xFF', '\x7F', '\x80'};
        for (const int bit : {0, 3, 6}) values.insert(static_cast<char>(bytes[at] ^ (1 << bit)));
        for (const char value : values)
            mutations.push_back({fmt::format("byte {} = {}", at, static_cast<unsigned char>(value)),
                                 replaced(bytes, at, 1, std::string(1, value))});
    }
}

struct Token {
    std::size_t at, size;
};

// The numbers of a text header.
std::vector<Token> numbersOf(const std::string& bytes, std::size_t header) {
    std::vector<Token> tokens;
    for (std::size_t at = 0; at < header;) {
        const bool begins = std::isdigit(static_cast<unsigned char>(bytes[at])) || bytes[at] == '-';
        if (!begins || (at > 0 && std::isalpha(static_cast<unsigned char>(bytes[at - 1])))) {
            ++at;
            continue;
        }
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789.-+e", at), header);
        tokens.push_back({at, end - at});
        at = end;
    }
    return tokens;
}

constexpr const char* kOtherNumbers[] = {"0",          "-1",
                                         "1",          "nan",
                                         "-nan",       "inf",
                                         "-inf",       "1e300",
                                         "-1e300",     "1e-300",
                                         "1e150",      "1e39",
                                         "1e20",       "4294967296",
                                         "1e308",      "1e-40",
                                         "1e-20",      "99999",
                                         "abc",        "",
                                         "-",          "1e",
                                         "3 3",        "%d",
                                         "0x7fffffff", "99999999999999999999",
                                         "2147483647"};

// Every number by other ones, by a word and by nothing.
void changeNumbers(const std::string& bytes, std::size_t header, std::vector<Mutation>& mutations) {
    for (const auto& [at, size] : numbersOf(bytes, header))
        for (const char* value : kOtherNumbers)
            mutations.push_back({fmt::format("'{}' at {} = '{}'", bytes.substr(at, size), at, value),
                                 replaced(bytes, at, size, value)});
}

// Several of them at once.
void changeSeveralNumbers(const std::string& bytes, std::size_t header, std::size_t count,
                          std::vector<Mutation>& mutations) {
    std::mt19937 random(20260102);
    const std::vector<Token> tokens = numbersOf(bytes, header);
    for (std::size_t i = 0; i < count; ++i) {
        std::string changed = bytes, what = fmt::format("numbers {}:", i);
        const std::size_t one = 1 + random() % 5;
        for (auto token = tokens.rbegin(); token != tokens.rend(); ++token) {  // from behind: places stay
            if (random() % tokens.size() >= one) continue;
            const char* value = kOtherNumbers[random() % std::size(kOtherNumbers)];
            changed.replace(token->at, token->size, value);
            what += fmt::format(" {}='{}'", token->at, value);
        }
        mutations.push_back({what, changed});
    }
}

// Lines left out, said twice, said twice with different numbers, swapped with the next one.
void changeLines(const std::string& bytes, std::size_t header, std::vector<Mutation>& mutations) {
    for (std::size_t at = 0; at < header;) {
        const std::size_t end = std::min(bytes.find('\n', at), header - 1) + 1;
        const std::string line = bytes.substr(at, end - at);
        mutations.push_back({"without " + line, replaced(bytes, at, line.size(), "")});
        mutations.push_back({"twice " + line, replaced(bytes, at, line.size(), line + line)});
        const std::size_t equals = std::min(line.find_first_of("=:"), line.size() - 1);
        for (const char* value :
             {" nan\n", " 0 0 0 0 0 0 0 0 0\n", " nan nan nan nan nan nan nan nan nan\n"}) {
            const std::string other = line.substr(0, equals + 1) + value;
            mutations.push_back({"before it: " + other, replaced(bytes, at, 0, other)});
            mutations.push_back({"behind it: " + other, replaced(bytes, end, 0, other)});
        }
        const std::size_t next = std::min(bytes.find('\n', end), header - 1) + 1;
        if (next > end)
            mutations.push_back(
                {"later " + line, replaced(bytes, at, next - at, bytes.substr(end, next - end) + line)});
        at = end;
    }
}

// Every field of a binary header, as the number that it may be.
void changeFields(const std::string& bytes, std::size_t header, std::vector<Mutation>& mutations) {
    const auto each = [&](auto zero, std::initializer_list<double> values) {
        using Number = decltype(zero);
        for (std::size_t at = 0; at + sizeof(Number) <= header; at += sizeof(Number))
            for (const double value : values) {
                const auto number = static_cast<Number>(value);
                mutations.push_back({fmt::format("{} bytes at {} = {}", sizeof(Number), at, value),
                                     replaced(bytes, at, sizeof(Number),
                                              {reinterpret_cast<const char*>(&number), sizeof(Number)})});
            }
    };
    const double inf = std::numeric_limits<double>::infinity(),
                 nan = std::numeric_limits<double>::quiet_NaN();
    each(float{}, {0, -1, nan, inf, -inf, 3e38, -3e38, 1e-38, 1e-45, 1e10, 0.5});
    each(std::int16_t{}, {0, -1, 1, 32767, -32768, 4, 7});
}

// Several numbers of a binary header at once.
void changeSeveralFields(const std::string& bytes, std::size_t header, std::size_t count,
                         std::vector<Mutation>& mutations) {
    std::mt19937 random(20260103);
    const float values[] = {0,
                            -1,
                            1,
                            3e38f,
                            1e30f,
                            1e19f,
                            1e-30f,
                            1e-20f,
                            1e-45f,
                            0.5f,
                            100,
                            -3e38f,
                            std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()};
    for (std::size_t i = 0; i < count; ++i) {
        std::string changed = bytes, what = fmt::format("fields {}:", i);
        for (std::size_t k = 0; k < 2 + random() % 5; ++k) {
            // pixdim, qform and sform are floats from byte 76 on
            const std::size_t at = 76 + 4 * (random() % ((header - 76) / 4));
            const float value = values[random() % std::size(values)];
            changed = replaced(changed, at, 4, {reinterpret_cast<const char*>(&value), 4});
            what += fmt::format(" {}={}", at, value);
        }
        mutations.push_back({what, changed});
    }
}

// Several bytes at once.
void changeSeveral(const std::string& bytes, std::size_t header, std::size_t count,
                   std::vector<Mutation>& mutations) {
    std::mt19937 random(20260101);
    for (std::size_t i = 0; i < count; ++i) {
        std::string changed = bytes;
        std::string what = fmt::format("case {}:", i);
        const std::size_t changes = 2 + random() % 4;
        for (std::size_t k = 0; k < changes; ++k) {
            const std::size_t at = random() % header;
            changed[at] = static_cast<char>(random());
            what += fmt::format(" {}={}", at, static_cast<unsigned char>(changed[at]));
        }
        mutations.push_back({what, changed});
    }
}

// Every n-th of them, n so that about `count` are left.
std::vector<Mutation> thinned(const std::vector<Mutation>& all, std::size_t count) {
    const std::size_t stride = std::max<std::size_t>(1, all.size() / count);
    std::vector<Mutation> some;
    for (std::size_t i = 0; i < all.size(); i += stride) some.push_back(all[i]);
    return some;
}

// ISOWAVE_EVERY_CORRUPTION=1 tries all of them, which takes minutes.
std::size_t casesEach() { return std::getenv("ISOWAVE_EVERY_CORRUPTION") ? SIZE_MAX / 2 : 1500; }

std::vector<Mutation> textMutations(const std::string& bytes, std::size_t header) {
    std::vector<Mutation> all;
    changeNumbers(bytes, header, all);
    changeSeveralNumbers(bytes, header, 5000, all);
    changeLines(bytes, header, all);
    changeBytes(bytes, header, all);
    changeSeveral(bytes, header, 3000, all);
    return thinned(all, casesEach());
}

std::vector<Mutation> binaryMutations(const std::string& bytes, std::size_t header) {
    std::vector<Mutation> all;
    changeFields(bytes, header, all);
    changeSeveralFields(bytes, header, 5000, all);
    changeBytes(bytes, header, all);
    changeSeveral(bytes, header, 3000, all);
    return thinned(all, casesEach());
}

// An oblique, anisotropic image: every field of its header says something.
itk::Image<short, 3>::Pointer obliqueImage() {
    auto image = test::patternImage<short>({7, 5, 4});
    itk::Image<short, 3>::DirectionType direction;
    const double c = std::cos(0.3), s = std::sin(0.3);
    const double rows[3][3] = {{c, -s, 0}, {s * c, c * c, -s}, {s * s, c * s, c}};
    for (unsigned i = 0; i < 3; ++i)
        for (unsigned j = 0; j < 3; ++j) direction[i][j] = rows[i][j];
    image->SetDirection(direction);
    const double spacing[3] = {0.7, 1.1, 2.5}, origin[3] = {-11.5, 22.25, 305};
    image->SetSpacing(spacing);
    image->SetOrigin(origin);
    return image;
}

TEST_F(Corruption, OfMetaImage) {
    test::writeItk(obliqueImage().GetPointer(), folder / "a.mha");
    std::string bytes = bytesOf(folder / "a.mha");
    sweep(folder / "a.mha", folder / "a.mha", textMutations(bytes, bytes.size() - 280));
    test::writeItk(obliqueImage().GetPointer(), folder / "b.mhd");
    bytes = bytesOf(folder / "b.mhd");
    sweep(folder / "b.mhd", folder / "b.mhd", textMutations(bytes, bytes.size()));
}

TEST_F(Corruption, OfNrrd) {
    test::writeItk(obliqueImage().GetPointer(), folder / "a.nrrd");
    std::string bytes = bytesOf(folder / "a.nrrd");
    sweep(folder / "a.nrrd", folder / "a.nrrd", textMutations(bytes, bytes.size() - 280));
    test::writeItk(obliqueImage().GetPointer(), folder / "b.nhdr");
    bytes = bytesOf(folder / "b.nhdr");
    sweep(folder / "b.nhdr", folder / "b.nhdr", textMutations(bytes, bytes.size()));
}

TEST_F(Corruption, OfNifti) {
    test::writeItk(obliqueImage().GetPointer(), folder / "a.nii");
    std::string bytes = bytesOf(folder / "a.nii");
    sweep(folder / "a.nii", folder / "a.nii", binaryMutations(bytes, 352));
    // Orientation by the quaternion alone, and by the matrix alone.
    const std::string none(2, '\0');
    sweep(folder / "a.nii", folder / "a.nii", binaryMutations(replaced(bytes, 252, 2, none), 352));
    sweep(folder / "a.nii", folder / "a.nii", binaryMutations(replaced(bytes, 254, 2, none), 352));
}

// ---- voxels that have to be decoded: whole files, header and voxels, byte by byte

// Bytes of the whole file, by ones that are often wrong and by random ones, and every length.
std::vector<Mutation> wholeFileMutations(const std::string& bytes) {
    std::vector<Mutation> all;
    changeBytes(bytes, bytes.size(), all);
    changeSeveral(bytes, bytes.size(), 2000, all);
    all = thinned(all, casesEach());
    for (std::size_t length = 1; length < bytes.size(); ++length)
        all.push_back({fmt::format("the first {} bytes", length), bytes.substr(0, length)});
    return all;
}

test::NiftiFile smallNifti() {
    test::NiftiFile file;
    file.size = {7, 5, 4};
    file.sformCode = 1;
    file.srow = {0.7, 0.1, 0, -11, 0, 1.1, 0.2, 22, 0, 0, 2.5, 305};
    std::vector<std::int16_t> voxels(140);
    for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<std::int16_t>(i * 37 % 251);
    file.voxels = test::bytes(voxels);
    return file;
}

TEST_F(Corruption, OfCompressedNifti) {
    const std::string bytes = gzipped(smallNifti().file());
    sweep(folder / "a.nii.gz", folder / "a.nii.gz", wholeFileMutations(bytes));
}

// Sizes of 64 bits, among them such as are right modulo 2^32, which is all that a gzip stream says of its length.
TEST_F(Corruption, OfNifti2) {
    test::NiftiFile file = smallNifti();
    file.second = true;
    sweep(folder / "a.nii", folder / "a.nii", binaryMutations(file.file(), 544));
    const std::string bytes = file.file();
    std::vector<Mutation> packed;
    for (std::size_t at = 16; at < 80; ++at)
        for (const char value : {'\1', '\x7F', '\xFF'})
            packed.push_back({fmt::format("byte {} before packing", at),
                              gzipped(replaced(bytes, at, 1, std::string(1, value)))});
    packed.push_back({"whole", gzipped(bytes)});
    sweep(folder / "b.nii.gz", folder / "b.nii.gz", packed);
}

TEST_F(Corruption, OfDecodedNrrd) {
    const std::string voxels = smallNifti().voxels;
    std::string text, hex;
    for (std::size_t i = 0; i < 140; ++i) text += std::to_string(i * 37 % 251) + (i % 7 == 6 ? "\n" : " ");
    for (const unsigned char c : voxels) hex += fmt::format("{:02x}", c);
    const auto file = [&](const std::string& encoding, const std::string& data) {
        return test::nrrdFile(
            "type: short\ndimension: 4\nsizes: 1 7 5 4\nendian: little\nkinds: list domain domain "
            "domain\nspace: LAS\nspace units: \"um\" \"um\" \"um\"\nspace directions: none "
            "(0.7,0,0) (0,1.1,0) (0,0,2.5)\nspace origin: (1,2,3)\nencoding: " +
                encoding + "\n",
            data);
    };
    const std::pair<const char*, std::string> files[] = {
        {"gzip", gzipped(voxels)}, {"ascii", text}, {"hex", hex}};
    for (const auto& [encoding, data] : files) {
        const std::string bytes = file(encoding, data);
        sweep(folder / "a.nrrd", folder / "a.nrrd", wholeFileMutations(bytes));
    }
}

TEST_F(Corruption, OfCompressedMetaImage) {
    test::writeItk(obliqueImage().GetPointer(), folder / "a.mha", true);
    const std::string bytes = bytesOf(folder / "a.mha");
    sweep(folder / "a.mha", folder / "a.mha", wholeFileMutations(bytes));
}

// Two frames with functional groups; the same compressed, which GDCM decodes in a child.
TEST_F(Corruption, OfDicom) {
    test::DicomSays says;
    says.frames = 2;
    says.at(1, 2, 3);
    std::vector<test::DicomOut> groups;
    for (const double z : {3.0, 5.0}) {
        test::DicomOut position, group;
        position.numbers(0x00200032, {1, 2, z});
        groups.push_back(group.sequence(0x00209113, {position}));
    }
    says.more.numbers(0x00281053, {0.5}).sequence(0x52009230, groups);
    says.pixels = test::slicePixels(1) + test::slicePixels(2);
    std::string bytes = test::dicomFile(test::dicomSet(says));
    sweep(folder / "a.dcm", folder / "a.dcm", binaryMutations(bytes, bytes.size() - 80));
    const std::vector<std::string> pieces{test::runLength(test::slicePixels(1)),
                                          test::runLength(test::slicePixels(2))};
    const test::DicomOut compressed = test::dicomSet(says, test::Vr::explicitLittle, false).pieces(pieces);
    bytes = test::dicomFile(compressed, "1.2.840.10008.1.2.5");
    sweep(folder / "b.dcm", folder / "b.dcm", thinned(binaryMutations(bytes, bytes.size()), casesEach() / 3));
}

}  // namespace
}  // namespace isowave
