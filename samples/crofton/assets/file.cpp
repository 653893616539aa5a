// SPDX-License-Identifier: MIT
#include "assets/file.hpp"

#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace crofton::assets {
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

tl::unexpected<Error> system_error(const std::string& path, const char* what) {
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

// `path` is for the message. A plain file that could not be written in full is removed.
Result<void> write_to(const std::string& target, const std::string& path, std::string_view contents) {
    File file(std::fopen(target.c_str(), "wb"));
    if (!file) return system_error(path, "cannot create");
    const bool written = std::fwrite(contents.data(), 1, contents.size(), file.get()) == contents.size();
    const bool closed = std::fclose(file.release()) == 0;
    if (written && closed) return {};
    auto error = system_error(path, "cannot write");
    if (!is_special(target)) std::remove(target.c_str());
    return error;
}

}  // namespace

Result<std::string> read_file(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) return fail(ErrorCode::io, kNoItem, path + ": is a folder");
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) return system_error(path, "cannot open");
    std::string contents;
    char block[1 << 16];
    for (std::size_t count; (count = std::fread(block, 1, sizeof block, file.get())) > 0;)
        contents.append(block, count);
    if (std::ferror(file.get())) return system_error(path, "cannot read");
    return contents;
}

Result<void> write_file(const std::string& path, std::string_view contents) {
    if (path == "-") {
        const bool written = std::fwrite(contents.data(), 1, contents.size(), stdout) == contents.size();
        if (!written || std::fflush(stdout) != 0) return system_error("standard output", "cannot write");
        return {};
    }
    const std::string target = behind_links(path);
    if (is_special(target)) return write_to(target, path, contents);
    const std::string partial = target + ".partial";
    if (auto written = write_to(partial, path, contents); !written) return written;
    if (std::rename(partial.c_str(), target.c_str()) != 0) {
        auto error = system_error(path, "cannot write");
        std::remove(partial.c_str());
        return error;
    }
    return {};
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

tl::unexpected<Error> in_file(const std::string& path, const std::string& what, Error error) {
    error.message = path + ": " + (what.empty() ? "" : what + ": ") + error.message;
    return tl::unexpected<Error>(std::move(error));
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
