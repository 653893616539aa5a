// SPDX-License-Identifier: MIT
// Writes a file so that readers see the old content or the new, whenever the writer is ended.
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/recovery.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "path.hpp"

#if defined(__unix__) || defined(__APPLE__)
#define CROFTON_POSIX_FILES 1
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace crofton::bake {
namespace {

Error write_error(const std::string& path, const char* what, int reason) {
    return fail(ErrorCode::io, kNoItem, {path, ": ", what, ": ", std::strerror(reason)});
}

// Resolves links, also to a file that does not exist yet. Returns the path itself if it is no link, or a circular one.
std::string behind_links(const std::string& path) {
    constexpr int kMostLinks = 40;  // as Linux follows
    std::filesystem::path target = path;
    std::error_code error;
    for (int links = 0; std::filesystem::is_symlink(target, error); ++links) {
        const auto next = std::filesystem::read_symlink(target, error);
        if (error || links == kMostLinks) return path;
        target = target.parent_path() / next;  // an absolute one takes its place
    }
    return target.string();
}

#if defined(CROFTON_POSIX_FILES)

constexpr int kWaits = 100;                        // for another writer of the same path,
constexpr useconds_t kWaitMicroseconds = 100'000;  // ten seconds in all

class OpenFile {
  public:
    OpenFile() = default;
    explicit OpenFile(int number) : number_(number) {}
    ~OpenFile() { close_now(); }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    [[nodiscard]] int number() const { return number_; }
    void open(const std::string& path, int flags) {
        close_now();
        number_ = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    }
    // Returns false if the system reports a failed write only now.
    bool close_now() { return number_ < 0 || ::close(std::exchange(number_, -1)) == 0; }

  private:
    int number_ = -1;
};

// 0, or the reason why not all was written.
int write_all(int file, std::span<const std::byte> bytes) {
    constexpr std::size_t kAtOnce = std::size_t{1} << 30;
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), std::min(bytes.size(), kAtOnce));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return 0;
}

Result<void> write_directly(const std::string& path, std::span<const std::byte> bytes) {
    OpenFile file;
    file.open(path, O_WRONLY);
    if (file.number() < 0) return write_error(path, "cannot open", errno);
    if (const int reason = write_all(file.number(), bytes)) return write_error(path, "cannot write", reason);
    if (!file.close_now()) return write_error(path, "cannot write", errno);
    return {};
}

bool same_file(int file, const std::string& path) {
    struct stat open {
    }, named{};
    return fstat(file, &open) == 0 && lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
           open.st_ino == named.st_ino;
}

// Opens the temporary file for this writer alone: a lock that ends with the process, whatever ends it. Between opening
// and locking another writer may have renamed or removed the file.
Result<void> open_partial(const std::string& partial, const std::string& path, OpenFile& file) {
    for (int wait = 0; wait < kWaits;) {
        file.open(partial, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK);
        if (file.number() < 0) return write_error(path, "cannot create", errno);
        struct stat status {};
        if (fstat(file.number(), &status) != 0) return write_error(path, "cannot create", errno);
        if (!S_ISREG(status.st_mode))
            return fail(ErrorCode::io, kNoItem, {path, ": cannot create: ", partial, " is in the way"});
        if (flock(file.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            ++wait;
            ::usleep(kWaitMicroseconds);
            continue;
        }
        if (same_file(file.number(), partial)) return {};
    }
    return fail(ErrorCode::io, kNoItem, {path, ": another program has been writing it for ten seconds"});
}

// 0, or the reason. Some file systems cannot flush one file (EINVAL); a disk error is reported here and nowhere else.
int flush_file(int file) {
    return fsync(file) != 0 && errno != EINVAL && errno != EROFS ? errno : 0;
}

// Lets the system write the file while the program goes on.
void begin_to_write([[maybe_unused]] int file) {
#if defined(SYNC_FILE_RANGE_WRITE)
    static_cast<void>(sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WRITE));
#endif
}

// The name itself is on the disk once its folder is. Where folders cannot be flushed it gets there in its time.
void flush_folder(const std::string& name) {
    OpenFile folder;
    folder.open(name, O_RDONLY | O_DIRECTORY);
    if (folder.number() >= 0) static_cast<void>(fsync(folder.number()));
}

std::string folder_of(const std::string& target) {
    const std::size_t slash = target.find_last_of('/');
    return slash == std::string::npos ? "." : target.substr(0, slash + 1);
}

Result<void> write_and_rename(const std::string& target, const std::string& path, std::span<const std::byte> bytes,
                              Flush flush) {
    // Memory may end before the file is there, not after.
    const std::string partial = target + ".partial", folder = folder_of(target);
    OpenFile file;
    if (auto opened = open_partial(partial, path, file); !opened) return opened;
    struct stat old {};
    const bool replaces = ::stat(target.c_str(), &old) == 0;
    int reason = ftruncate(file.number(), 0) != 0 ? errno : write_all(file.number(), bytes);
    if (reason == 0 && replaces) static_cast<void>(fchmod(file.number(), old.st_mode & 07777));
    if (reason == 0 && flush == Flush::later) begin_to_write(file.number());
    if (reason == 0 && flush == Flush::now) reason = flush_file(file.number());
    if (reason == 0 && std::rename(partial.c_str(), target.c_str()) != 0) reason = errno;
    if (reason == 0) {
        if (flush == Flush::now) flush_folder(folder);
        return {};
    }
    std::remove(partial.c_str());
    return write_error(path, "cannot write", reason);
}

Result<void> flush_one(const std::string& path) {
    OpenFile file;
    file.open(path, O_RDONLY | O_NONBLOCK);
    if (file.number() < 0) return write_error(path, "cannot open", errno);
    const int reason = flush_file(file.number());
    return reason == 0 ? Result<void>() : write_error(path, "cannot write", reason);
}

bool is_special(const std::string& target) {
    struct stat status {};
    return ::stat(target.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

#else

void flush_folder(const std::string&) {}
std::string folder_of(const std::string&) {
    return {};
}
Result<void> flush_one(const std::string&) {
    return {};
}

Result<void> write_and_rename(const std::string& target, const std::string& path, std::span<const std::byte> bytes,
                              Flush) {
    const std::string partial = target + ".partial";
    std::FILE* file = std::fopen(partial.c_str(), "wb");
    if (!file) return write_error(path, "cannot create", errno);
    bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    written = std::fclose(file) == 0 && written;
    int reason = errno;
    std::error_code error;
    if (written) std::filesystem::rename(partial, target, error);
    if (written && !error) return {};
    if (error) reason = error.value();
    std::remove(partial.c_str());
    return write_error(path, "cannot write", reason);
}

bool is_special(const std::string&) {
    return false;
}

Result<void> write_directly(const std::string& path, std::span<const std::byte> bytes) {
    return write_and_rename(path, path, bytes, Flush::now);
}

#endif

}  // namespace

Result<void> write_file(const std::string& path, std::span<const std::byte> bytes, Flush flush) {
    if (auto checked = check_path(path); !checked) return checked;
    // Links of /proc lead to pipes that have no path of their own: these are opened by the link.
    return detail::recover([&]() -> Result<void> {
        if (is_special(path)) return write_directly(path, bytes);
        return write_and_rename(behind_links(path), path, bytes, flush);
    });
}

Result<void> flush_files(std::span<const std::string> paths) {
    return detail::recover([&]() -> Result<void> {
        Result<void> result;
        Vector<std::string> folders;
        for (const std::string& path : paths) {
            auto flushed = check_path(path);
            const std::string target = flushed ? behind_links(path) : std::string(), folder = folder_of(target);
            if (flushed && !is_special(target)) flushed = flush_one(target);
            if (!flushed && result) result = flushed;
            if (target.empty()) continue;
            if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(folder);
        }
        for (const std::string& folder : folders) flush_folder(folder);
        return result;
    });
}

}  // namespace crofton::bake
