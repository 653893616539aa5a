#include "picture.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace crofton::viewer {

Result<void> write_text(const std::string& path, const std::string& text) {
    const auto failed = [&](const char* what) {
        return fail(ErrorCode::io, kNoItem, path + ": " + what + ": " + std::strerror(errno));
    };
    if (path == "-") {
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) return failed("cannot write");
        return {};
    }
    const std::string partial = path + ".partial";
    std::FILE* file = std::fopen(partial.c_str(), "wb");
    if (file == nullptr) return failed("cannot create");
    const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    const bool closed = std::fclose(file) == 0;
    if (written && closed && std::rename(partial.c_str(), path.c_str()) == 0) return {};
    auto error = failed("cannot write");
    std::remove(partial.c_str());
    return error;
}

Result<void> write_png(const std::string& path, const render::Image& image) {
    std::string bytes;
    const auto append = [](void* user, void* data, int size) {
        static_cast<std::string*>(user)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    const auto width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (stbi_write_png_to_func(append, &bytes, width, height, 4, image.rgba.data(), 4 * width) == 0)
        return fail(ErrorCode::internal, kNoItem, path + ": the picture could not be encoded");
    return write_text(path, bytes);
}

}  // namespace crofton::viewer
