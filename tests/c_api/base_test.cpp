// SPDX-License-Identifier: MIT
#include <crofton/core/error.hpp>
#include <crofton/core/version.hpp>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/base") {
    TEST_CASE("a null handle is a status and a text that names the function") {
        CHECK(crofton_scene_update(nullptr, nullptr, nullptr) == CROFTON_BAD_HANDLE);
        CHECK(mentions(crofton_last_error(), "crofton_scene_update"));
        CHECK(mentions(crofton_last_error(), "NULL"));
        CHECK(crofton_last_error_item() == CROFTON_NO_ITEM);
        CHECK(crofton_scene_destroy(nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_tree_destroy(nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_view_result_destroy(nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_broadphase_destroy(nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_shape_destroy(nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_triangulator_destroy(nullptr) == CROFTON_BAD_HANDLE);
    }

    TEST_CASE("a handle of another kind is refused") {
        const Broadphase broadphase = make_broadphase();
        CHECK(crofton_scene_update(reinterpret_cast<crofton_scene*>(broadphase.get()), nullptr, nullptr) ==
              CROFTON_BAD_HANDLE);
        CHECK(crofton_tree_destroy(reinterpret_cast<crofton_tree*>(broadphase.get())) == CROFTON_BAD_HANDLE);
    }

    TEST_CASE("a place for the new handle that is NULL is refused") {
        CHECK(crofton_scene_create(nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_view_result_create(nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_broadphase_create(nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_triangulator_create(nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_tree_create(nullptr, nullptr, 0, nullptr, nullptr) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("every thread has its own last error") {
        CHECK(crofton_scene_destroy(nullptr) == CROFTON_BAD_HANDLE);
        std::string other = "unset";
        std::thread([&] { other = crofton_last_error(); }).join();
        CHECK(other.empty());
        CHECK(mentions(crofton_last_error(), "crofton_scene_destroy"));
    }

    TEST_CASE("statuses are the library's error codes, one up, and all have names") {
        CHECK(std::string(crofton_status_name(CROFTON_OK)) == "ok");
        for (int status = CROFTON_INVALID_ARGUMENT; status <= CROFTON_INTERNAL; ++status)
            CHECK(std::string(crofton_status_name(status)) ==
                  crofton::to_string(static_cast<crofton::ErrorCode>(status - 1)));
        CHECK(std::string(crofton_status_name(CROFTON_BUSY)) == "busy");
        CHECK(std::string(crofton_status_name(77)) == "unknown status");
    }

    TEST_CASE("the web package has the same names of statuses") {
        std::ifstream file(CROFTON_WEB_STATUSES);
        std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        text = text.substr(0, text.find(']'));
        std::string names, expected;
        for (std::size_t at = text.find('\''); at != std::string::npos; at = text.find('\'', at + 1)) {
            const std::size_t end = text.find('\'', at + 1);
            names += text.substr(at + 1, end - at - 1) + ", ";
            at = end;
        }
        for (int status = CROFTON_OK; status <= CROFTON_OUT_OF_MEMORY; ++status)
            expected += std::string(crofton_status_name(status)) + ", ";
        CHECK(names == expected);
    }

    TEST_CASE("the library returns its versions") {
        CHECK(crofton_api_version() == CROFTON_API_VERSION);
        CHECK(std::string(crofton_version_string()) == crofton::version_string());
    }
}
