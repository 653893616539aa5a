#include "report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.hpp"

namespace crofton::cli {
int report_error(std::string_view subject, const Error& error) {
    std::fprintf(stderr, "crofton: %.*s%s%s", static_cast<int>(subject.size()), subject.data(),
                 subject.empty() ? "" : ": ", error.message.c_str());
    if (error.item != kNoItem) std::fprintf(stderr, " (item %llu)", static_cast<unsigned long long>(error.item));
    std::fputc('\n', stderr);
    return kBadInput;
}

Result<void> write_json(const std::string& path, const nlohmann::json& document) {
    return write_file(path, document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace crofton::cli
