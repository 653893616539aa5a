#include "assets/file.hpp"

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
    const std::string partial = path + ".partial";
    File file(std::fopen(partial.c_str(), "wb"));
    if (!file) return system_error(path, "cannot create");
    const bool written = std::fwrite(contents.data(), 1, contents.size(), file.get()) == contents.size();
    const bool closed = std::fclose(file.release()) == 0;
    if (!written || !closed || std::rename(partial.c_str(), path.c_str()) != 0) {
        auto error = system_error(path, "cannot write");
        std::remove(partial.c_str());
        return error;
    }
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
