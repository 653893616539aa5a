// SPDX-License-Identifier: MIT
#include "assets/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <crofton/bake/baked_scene.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>

namespace crofton::assets {
namespace {

std::atomic<std::size_t> written_count{0};

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

Error system_error(const std::string& path, const char* what) {
    return fail(ErrorCode::io, kNoItem, path + ": " + what + ": " + std::strerror(errno));
}

// The file that a link leads to; the path itself where it is none.
std::string behind_links(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_symlink(path, error)) return path;
    const auto target = std::filesystem::weakly_canonical(path, error);
    return error ? path : target.string();
}

// A device, a pipe or a socket: to be written to, and never to be replaced by a file of its name.
bool is_special(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
           !std::filesystem::is_directory(status);
}

Result<std::string> read_open(File file, const std::string& path, std::uint64_t limit) {
    if (!file) return system_error(path, "cannot open");
    std::string contents;
    char block[1 << 16];
    for (std::size_t count; (count = std::fread(block, 1, sizeof block, file.get())) > 0;) {
        if (contents.size() + count > limit) return in_file(path, "", over_limit("bytes", limit));
        contents.append(block, count);
    }
    if (std::ferror(file.get())) return system_error(path, "cannot read");
    return contents;
}

// The file that `name` leads to, links followed, where that is below the folder. Backslashes count as slashes, so that
// a name is refused on every system or on none.
Result<std::string> path_below(const std::string& folder, const std::string& name) {
    const auto refused = [&](const char* why) {
        return fail(ErrorCode::io, kNoItem, "'" + name.substr(0, 200) + "' " + why);
    };
    if (name.empty()) return refused("is no file's name");
    if (const std::size_t zero = name.find('\0'); zero != name.npos)
        return fail(ErrorCode::io, kNoItem,
                    "'" + name.substr(0, std::min<std::size_t>(zero, 200)) + "' goes on after a byte 0");
    if (name[0] == '/' || name[0] == '\\' || (name.size() > 1 && name[1] == ':'))
        return refused("is an absolute path; only files below the folder of the file that names it are read");
    for (std::size_t begin = 0; begin <= name.size();) {
        const std::size_t end = std::min(name.find_first_of("/\\", begin), name.size());
        if (name.substr(begin, end - begin) == "..")
            return refused("leads out of its folder; only files below the folder of the file that names it are read");
        begin = end + 1;
    }
    std::error_code error;
    const auto base = std::filesystem::canonical(folder.empty() ? "." : folder, error);
    const auto path = error ? base : std::filesystem::canonical(folder + name, error);
    if (error) return fail(ErrorCode::io, kNoItem, folder + name + ": cannot open: " + error.message());
    const auto [end_of_base, rest] = std::mismatch(base.begin(), base.end(), path.begin(), path.end());
    if (end_of_base != base.end() || rest == path.end())
        return refused("is a link that leads out of its folder; only files below it are read");
    return path.string();
}

}  // namespace

Result<std::string> read_file(const std::string& path, std::uint64_t limit) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) return fail(ErrorCode::io, kNoItem, path + ": is a folder");
    return read_open(File(std::fopen(path.c_str(), "rb")), path, limit);
}

Result<std::string> read_file_below(const std::string& folder, const std::string& name, std::uint64_t limit) {
    const auto path = path_below(folder, name);
    if (!path) return path.error();
    // Opening does not wait for the other end of a pipe; what was opened is what is looked at.
    const int number = ::open(path->c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    File file(number < 0 ? nullptr : ::fdopen(number, "rb"));
    if (!file) return system_error(folder + name, "cannot open");
    struct stat status {};
    if (fstat(number, &status) != 0) return system_error(folder + name, "cannot open");
    if (!S_ISREG(status.st_mode)) return fail(ErrorCode::io, kNoItem, folder + name + ": is no regular file");
    return read_open(std::move(file), folder + name, limit);
}

Result<void> write_file(const std::string& path, std::string_view contents) {
    if (path == "-") {
        const bool written = std::fwrite(contents.data(), 1, contents.size(), stdout) == contents.size();
        if (!written || std::fflush(stdout) != 0) return system_error("standard output", "cannot write");
        return {};
    }
    // A pipe may keep its writer waiting for ever, and nothing is half written there.
    std::unique_lock<std::mutex> lock(writing(), std::defer_lock);
    if (!is_special(path)) lock.lock();
    auto written = bake::write_file(path, std::as_bytes(std::span(contents)));
    if (written) ++written_count;
    return written;
}

std::mutex& writing() {
    static std::mutex mutex;
    return mutex;
}

std::size_t files_written() {
    return written_count;
}

Result<void> check_writable(const std::string& path) {
    if (path == "-") return {};
    const std::string target = behind_links(path);
    std::error_code ignored;
    if (path.empty()) return fail(ErrorCode::io, kNoItem, "a file's name is empty");
    if (std::filesystem::is_directory(target, ignored))
        return fail(ErrorCode::io, kNoItem, path + ": is a folder; name a file in it");
    const std::string place = is_special(target) ? target : folder(target).empty() ? "." : folder(target);
    if (::access(place.c_str(), W_OK) != 0) return system_error(path, "cannot create");
    return {};
}

Error in_file(const std::string& path, const std::string& what, Error error) {
    error.message = path + ": " + (what.empty() ? "" : what + ": ") + error.message;
    return error;
}

std::string file_name(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

std::string folder(const std::string& path) {
    return path.substr(0, path.find_last_of('/') + 1);
}

std::string extension(const std::string& path) {
    const std::string name = file_name(path);
    const std::size_t dot = name.find_last_of('.');
    if (dot == std::string::npos) return {};
    std::string result = name.substr(dot + 1);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return result;
}

}  // namespace crofton::assets
