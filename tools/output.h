// Where results go: a folder filled all at once, or a file whose folder may have to be made first. Whatever a
// job that does not reach commit() made is taken away again, folders included.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/atomic_file.h"

namespace isowave::tools {

// Makes the missing folders on the way to `folder`; removes those it made unless keep() was called.
class MadeFolders {
  public:
    // Throws OperationError when that fails.
    explicit MadeFolders(const std::filesystem::path& folder);
    ~MadeFolders();
    MadeFolders(const MadeFolders&) = delete;
    MadeFolders& operator=(const MadeFolders&) = delete;
    void keep() { made_.clear(); }

  private:
    void removeMade();

    std::vector<std::filesystem::path> made_;  // outermost first
};

// What a job reads, so that nothing that it writes takes the place of it.
class Inputs {
  public:
    // Files, and folders of slices: every file below those is an input. So are the voxels beside a header.
    explicit Inputs(std::vector<std::filesystem::path> paths = {});
    // Throws UsageError when `place` is one of them, by whatever name: symbolic and hard links count.
    void refuse(const std::filesystem::path& place) const;

  private:
    bool contain(const std::filesystem::path& place) const;

    std::vector<std::filesystem::path> paths_;
};

// Throws UsageError when two results of a command would be one file, by whatever names. Devices may be named twice.
void refuseSamePlace(const std::filesystem::path& a, const std::filesystem::path& b);

// A folder that gets all files of a job at once. They are written into a hidden folder, on the same disk,
// and renamed at the end.
class OutputFolder {
  public:
    // Throws OperationError at once when nothing can be written there.
    explicit OutputFolder(const std::filesystem::path& folder, Inputs inputs = Inputs());
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    const std::filesystem::path& folder() const { return folder_; }
    // The last component of the folder's name, which its files start with.
    std::string name() const { return folder_.filename().string(); }
    // `place` gets a result that is written apart from those of the folder. Throws UsageError when it is the folder.
    void keepFree(const std::filesystem::path& place);
    // Throws UsageError when folder()/name is an input, or a place that was to be kept free.
    void refuseTaken(const std::string& name) const;
    // Where to write the file that will be folder()/name. Throws OperationError when a folder has that name,
    // UsageError when it is taken.
    std::filesystem::path place(const std::string& name);
    // The same for a folder, which the caller makes and fills. One that is there is replaced as a whole, and only where mayReplace(it)
    // says so: otherwise OperationError.
    std::filesystem::path placeFolder(const std::string& name,
                                      const std::function<bool(const std::filesystem::path&)>& mayReplace);
    // Puts all files into the folder, in place of those of the same names; other files there stay. Throws
    // OperationError, and the folder is as it was.
    void commit();
    // Names the folder where a message names the hidden one.
    std::string publicText(std::string message) const;

  private:
    void replaceFiles();

    std::filesystem::path folder_;
    Inputs inputs_;
    std::vector<std::filesystem::path> keptFree_;
    MadeFolders parents_;
    std::filesystem::path hidden_;
    std::vector<std::string> names_;     // of files and of folders
    std::set<std::string> folderNames_;  // those of folders
};

// Into an open file, all of it: a full disk is found here. commit() is the caller's. Throws OperationError.
void writeWhole(AtomicFile& file, const std::string& text);

// Name -> bytes, into the folder. Throws OperationError when one cannot be written.
void writeFiles(OutputFolder& out, const std::map<std::string, std::string>& files);

// One file as result: makes the folders on the way and finds out at once whether the file can be written.
class OutputFile {
  public:
    explicit OutputFile(const std::filesystem::path& path);
    // After the file was written (atomically, by its writer).
    void commit() { parents_.keep(); }

  private:
    MadeFolders parents_;
};

// The same with its bytes: written at once, put into its place by commit().
class ResultFile {
  public:
    // Throws OperationError at once where it cannot be written.
    explicit ResultFile(const std::filesystem::path& place) : folders_(place), file_(place) {}
    // Throws OperationError: the disk is full.
    void write(const std::string& bytes) { writeWhole(file_, bytes); }
    void commit() {
        file_.commit();
        folders_.commit();
    }

  private:
    OutputFile folders_;
    AtomicFile file_;
};

}  // namespace isowave::tools
