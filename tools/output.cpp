#include "tools/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/links.h"
#include "isowave/error.h"
#include "isowave/image.h"

namespace isowave::tools {
namespace fs = std::filesystem;
namespace {

// Absolute, without "." and "..", without a slash at the end: out/part/ and out/part are one folder.
fs::path tidy(const fs::path& path) {
    fs::path result = fs::absolute(path).lexically_normal();
    if (!result.has_filename()) result = result.parent_path();
    return result;
}

void refuseFolder(const fs::path& place) {
    if (fs::is_directory(place))
        throw OperationError(place.string(), "is a folder, where a result should go; move it away");
}

}  // namespace

Inputs::Inputs(std::vector<fs::path> paths) : paths_(std::move(paths)) {
    const std::size_t named = paths_.size();
    for (std::size_t i = 0; i < named; ++i)
        for (fs::path& voxels : voxelFilesOf(paths_[i])) paths_.push_back(std::move(voxels));
}

bool Inputs::contain(const fs::path& place) const {
    std::error_code ignored;
    for (const fs::path& input : paths_) {
        if (fs::equivalent(input, place, ignored)) return true;
        if (!fs::is_directory(input, ignored)) continue;
        for (auto entry = fs::recursive_directory_iterator(input, ignored);
             entry != fs::recursive_directory_iterator(); entry.increment(ignored))
            if (entry->is_regular_file(ignored) && fs::equivalent(entry->path(), place, ignored)) return true;
    }
    return false;
}

void Inputs::refuse(const fs::path& place) const {
    std::error_code ignored;
    // A folder of slices may get results beside the slices.
    if (!fs::exists(place, ignored) || fs::is_directory(place, ignored) || !contain(place)) return;
    throw UsageError(place.string() + " is what this command reads; choose another name for the result");
}

void refuseSamePlace(const fs::path& a, const fs::path& b) {
    std::error_code ignored;
    const auto found = [&](const fs::path& place) {
        return fs::weakly_canonical(behindLinks(tidy(place)), ignored);
    };
    if (fs::is_other(a, ignored) || found(a) != found(b)) return;
    throw UsageError(
        fmt::format("{} would get two results; choose another name for one of them", b.string()));
}

MadeFolders::MadeFolders(const fs::path& folder) {
    std::vector<fs::path> missing;
    std::error_code error;
    for (fs::path p = folder; !p.empty() && !fs::exists(p, error) && p != p.parent_path();
         p = p.parent_path())
        missing.push_back(p);
    std::reverse(missing.begin(), missing.end());
    for (const fs::path& p : missing) {
        if (fs::create_directory(p, error)) made_.push_back(p);
        if (error) break;
    }
    if (fs::is_directory(folder)) return;
    const std::string reason = error ? error.message() : "a file of that name is in the way";
    removeMade();
    throw OperationError(folder.string(), "cannot make this folder (" + reason + "); choose another output");
}

MadeFolders::~MadeFolders() { removeMade(); }

void MadeFolders::removeMade() {
    std::error_code ignored;
    for (auto p = made_.rbegin(); p != made_.rend(); ++p) fs::remove(*p, ignored);  // only empty ones go
}

OutputFolder::OutputFolder(const fs::path& folder, Inputs inputs)
    : folder_(tidy(folder)), inputs_(std::move(inputs)), parents_(folder_.parent_path()) {
    std::error_code error;
    if (!folder_.has_filename())
        throw OperationError(folder.string(), "is not a name for a folder; give -o out/part");
    if (fs::exists(folder_, error) && !fs::is_directory(folder_, error))
        throw OperationError(folder_.string(), "is a file; -o names the folder that gets the results");
    if (fs::is_symlink(folder_, error) && !fs::exists(folder_, error))
        throw OperationError(folder_.string(), "is a link to nothing; make the folder that it leads to");
    // Inside the folder when there is one (it may be a link to another disk), beside it when there is none.
    const fs::path where = fs::exists(folder_, error) ? folder_ : folder_.parent_path();
    const fs::path hidden = where / ("." + name() + ".part-" + std::to_string(::getpid()));
    if (!fs::create_directory(hidden, error)) {
        const std::string reason = error ? error.message() : "a temporary folder is in the way";
        throw OperationError(where.string(), "cannot write here (" + reason + "); choose another output");
    }
    hidden_ = hidden;
}

void OutputFolder::keepFree(const fs::path& place) {
    refuseSamePlace(folder_, place);
    keptFree_.push_back(place);
}

void OutputFolder::refuseTaken(const std::string& name) const {
    inputs_.refuse(folder_ / name);
    for (const fs::path& place : keptFree_) refuseSamePlace(folder_ / name, place);
}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    if (!hidden_.empty()) fs::remove_all(hidden_, ignored);
}

fs::path OutputFolder::place(const std::string& name) {
    refuseTaken(name);
    refuseFolder(folder_ / name);
    names_.push_back(name);
    return hidden_ / name;
}

fs::path OutputFolder::placeFolder(const std::string& name,
                                   const std::function<bool(const fs::path&)>& mayReplace) {
    refuseTaken(name);
    const fs::path place = folder_ / name;
    std::error_code ignored;
    if (fs::exists(place, ignored) && !(fs::is_directory(place, ignored) && mayReplace(place)))
        throw OperationError(place.string(),
                             "is there, and nothing that this command has written; move it away");
    names_.push_back(name);
    folderNames_.insert(name);
    return hidden_ / name;
}

void OutputFolder::commit() {
    std::error_code error;
    if (!fs::exists(folder_)) {
        fs::rename(hidden_, folder_, error);  // all at once
        if (error)
            throw OperationError(folder_.string(),
                                 "cannot put the finished files here (" + error.message() + ")");
    } else {
        for (const std::string& name : names_)
            if (!folderNames_.count(name)) refuseFolder(folder_ / name);
        replaceFiles();
        fs::remove_all(hidden_, error);
    }
    hidden_.clear();
    parents_.keep();
}

// A list of renamings of which all are done, or none.
//   old files:  folder/name        -> hidden/replaced/name, as a second name, or by renaming where a disk has no links
//   new files:  hidden/name        -> folder/name
// Undone backwards, each in turn, when one fails. Killed between two of them, every name has its old file or its new one.
void OutputFolder::replaceFiles() {
    const fs::path replaced = hidden_ / "replaced";
    std::vector<std::pair<fs::path, fs::path>> done;
    std::error_code error;
    const auto move = [&](const fs::path& from, const fs::path& to) {
        fs::rename(from, to, error);
        if (!error) done.emplace_back(from, to);
        return !error;
    };
    const auto setAside = [&](const fs::path& from, const fs::path& to) {
        fs::create_hard_link(from, to, error);
        if (error) return move(from, to);
        done.emplace_back(from, to);
        return true;
    };
    const auto replace = [&](const std::string& name) {
        std::error_code ignored;
        const bool there = fs::exists(fs::symlink_status(folder_ / name, ignored));
        return (!there || setAside(folder_ / name, replaced / name)) && move(hidden_ / name, folder_ / name);
    };
    fs::create_directory(replaced, error);
    if (error)
        throw OperationError(folder_.string(), "cannot move the old files aside (" + error.message() + ")");
    for (const std::string& name : names_) {
        if (replace(name)) continue;
        std::error_code ignored;
        for (auto step = done.rbegin(); step != done.rend(); ++step)
            fs::rename(step->second, step->first, ignored);
        throw OperationError((folder_ / name).string(),
                             "cannot put the finished file here (" + error.message() + ")");
    }
}

std::string OutputFolder::publicText(std::string message) const {
    const std::string from = hidden_.string(), to = folder_.string();
    if (from.empty()) return message;
    for (std::size_t i = 0; (i = message.find(from, i)) != std::string::npos; i += to.size())
        message.replace(i, from.size(), to);
    return message;
}

void writeWhole(AtomicFile& file, const std::string& text) {
    try {
        file.stream() << text << std::flush;
    } catch (const std::ios_base::failure&) {
        throw OperationError(file.place().string(),
                             std::string("writing failed (") + std::strerror(errno) + "); is the disk full?");
    }
}

void writeFiles(OutputFolder& out, const std::map<std::string, std::string>& files) {
    for (const auto& [name, bytes] : files) {
        AtomicFile file(out.place(name));
        file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.commit();
    }
}

OutputFile::OutputFile(const fs::path& path) : parents_(tidy(path).parent_path()) {
    const AtomicFile probe(path);  // throws when the place is a folder or cannot be written
}

}  // namespace isowave::tools
