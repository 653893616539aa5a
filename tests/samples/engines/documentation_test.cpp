// SPDX-License-Identifier: MIT
// Code in the documentation is code that is compiled: every C and C++ block is found, line by line, in a source.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Lines = std::vector<std::string>;

std::string trimmed(const std::string& line) {
    const auto first = line.find_first_not_of(" \t"), last = line.find_last_not_of(" \t\r");
    return first == std::string::npos ? std::string() : line.substr(first, last - first + 1);
}

Lines lines_of(const std::string& path) {
    std::ifstream file(CROFTON_SOURCE_DIR "/" + path);
    REQUIRE_MESSAGE(file, path);
    Lines lines;
    for (std::string line; std::getline(file, line);) lines.push_back(trimmed(line));
    return lines;
}

// The blocks fenced as c or cpp, without empty lines.
std::vector<Lines> code_blocks(const Lines& page) {
    std::vector<Lines> blocks;
    bool in_code = false;
    for (const std::string& line : page) {
        if (line.rfind("```", 0) == 0) {
            in_code = !in_code && (line == "```cpp" || line == "```c");
            if (in_code) blocks.emplace_back();
        } else if (in_code && !line.empty()) {
            blocks.back().push_back(line);
        }
    }
    return blocks;
}

bool occurs_in(const Lines& block, Lines source) {
    std::erase(source, std::string());
    return std::search(source.begin(), source.end(), block.begin(), block.end()) != source.end();
}

}  // namespace

TEST_SUITE("engines/documentation") {
    TEST_CASE("every code block of the pages is part of a source that is compiled") {
        struct Page {
            std::string name;
            std::size_t least_blocks;
        };
        std::vector<Page> pages = {{"docs/integrate.md", 8}, {"README.md", 1}};
        std::vector<Lines> sources = {lines_of("tests/samples/engines/integrate_test.cpp"),
                                      lines_of("samples/hello_cull/main.cpp"),
                                      lines_of("samples/hello_world/main.cpp"),
                                      lines_of("samples/hello_frame/main.cpp"),
                                      lines_of("samples/c_hello/main.c"),
                                      lines_of("samples/executors/tbb_executor.hpp")};
        // The pages take their examples from tests/<room>/<module>/guide_test.cpp and …_guide_test.cpp.
        for (const auto& file : std::filesystem::recursive_directory_iterator(CROFTON_SOURCE_DIR "/tests")) {
            const std::string name = file.path().filename().string();
            if (!name.ends_with("guide_test.cpp")) continue;
            sources.push_back(lines_of(file.path().lexically_relative(CROFTON_SOURCE_DIR).string()));
            if (name == "guide_test.cpp")
                pages.push_back({"docs/" + file.path().parent_path().filename().string() + ".md", 1});
        }
        for (const auto& file : std::filesystem::directory_iterator(CROFTON_SOURCE_DIR "/docs"))
            if (file.path().extension() == ".md") pages.push_back({"docs/" + file.path().filename().string(), 0});
        CHECK(pages.size() > 2);
        for (const Page& page : pages) {
            const auto blocks = code_blocks(lines_of(page.name));
            CHECK(blocks.size() >= page.least_blocks);
            for (const Lines& block : blocks) {
                CAPTURE(page.name);
                REQUIRE_FALSE(block.empty());
                CAPTURE(block.front());
                CHECK(std::any_of(std::begin(sources), std::end(sources),
                                  [&](const Lines& source) { return occurs_in(block, source); }));
            }
        }
    }

    TEST_CASE("the quick start fits on a screen") {
        CHECK(lines_of("samples/hello_cull/main.cpp").size() <= 40);
        CHECK(lines_of("samples/hello_frame/main.cpp").size() <= 80);
    }
}
