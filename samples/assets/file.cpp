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

}  // namespace

Result<std::string> read_file(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) return fail(ErrorCode::io, kNoItem, path + ": is a folder");
    const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
    if (!file) return fail(ErrorCode::io, kNoItem, path + ": cannot open: " + std::strerror(errno));
    std::string contents;
    char block[1 << 16];
    for (std::size_t count; (count = std::fread(block, 1, sizeof block, file.get())) > 0;)
        contents.append(block, count);
    if (std::ferror(file.get())) return fail(ErrorCode::io, kNoItem, path + ": cannot read: " + std::strerror(errno));
    return contents;
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
