#include "report.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"

namespace crofton::cli {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

tl::unexpected<Error> system_error(const std::string& path, const char* what) {
    return fail(ErrorCode::io, kNoItem, path + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

int report_error(std::string_view subject, const Error& error) {
    std::fprintf(stderr, "crofton: %.*s%s%s", static_cast<int>(subject.size()), subject.data(),
                 subject.empty() ? "" : ": ", error.message.c_str());
    if (error.item != kNoItem) std::fprintf(stderr, " (item %llu)", static_cast<unsigned long long>(error.item));
    std::fputc('\n', stderr);
    return kBadInput;
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

Result<void> write_json(const std::string& path, const nlohmann::json& document) {
    return write_file(path, document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

Result<std::string> read_file(const std::string& path) {
    File file(std::fopen(path.c_str(), "rb"));
    if (!file) return system_error(path, "cannot open");
    std::string contents;
    char block[1 << 16];
    for (std::size_t count; (count = std::fread(block, 1, sizeof block, file.get())) > 0;)
        contents.append(block, count);
    if (std::ferror(file.get())) return system_error(path, "cannot read");
    return contents;
}

}  // namespace crofton::cli
