// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <crofton/bake/baked_scene.hpp>
#include <error_of.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>
#include <vector>

#include "../../kill_writer.hpp"

using namespace crofton;

namespace {

// A folder that is gone after the test.
struct Folder {
    Folder() {
        path = (std::filesystem::temp_directory_path() / "crofton-write-XXXXXX").string();
        REQUIRE(mkdtemp(path.data()) != nullptr);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const { return path + "/" + name; }
    [[nodiscard]] std::ptrdiff_t count() const {
        return std::distance(std::filesystem::directory_iterator(path), std::filesystem::directory_iterator());
    }
    std::string path;
};

// The program stands in a folder until the end of the scope.
class Standing {
  public:
    explicit Standing(const std::string& folder) : before_(std::filesystem::current_path()) {
        std::filesystem::current_path(folder);
    }
    ~Standing() { std::filesystem::current_path(before_); }
    Standing(const Standing&) = delete;
    Standing& operator=(const Standing&) = delete;

  private:
    std::filesystem::path before_;
};

// Where the program runs as root, which may read everything, it is another user until the end of the scope.
class AsNobody {
  public:
    AsNobody() { REQUIRE((!root_ || seteuid(65534) == 0)); }
    ~AsNobody() { CHECK((!root_ || seteuid(0) == 0)); }
    AsNobody(const AsNobody&) = delete;
    AsNobody& operator=(const AsNobody&) = delete;

  private:
    bool root_ = geteuid() == 0;
};

Result<void> write(const std::string& path, const std::string& text) {
    return bake::write_file(path, std::as_bytes(std::span(text)));
}

std::string contents(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// A letter as many times as fills some pages.
std::string filled(std::uint64_t round) {
    return std::string(300'000 + 1000 * (round % 7), static_cast<char>('a' + round % 26));
}

bool is_filled(const std::string& text) {
    return !text.empty() && text == std::string(text.size(), text[0]) && text.size() >= 300'000;
}

// Runs `body` in a child process; its exit status, or −1 where a signal ended it.
template <class Body>
int in_child(const Body& body) {
    const pid_t child = fork();
    if (child == 0) _exit(body());
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void limit_file_size(rlim_t bytes) {
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
}

// Answers this program's calls of fsync until the end of the scope, with 0 or the reason of a failure.
class Disk {
  public:
    explicit Disk(std::function<int(int file)> flush) : flush_(std::move(flush)) { current = this; }
    ~Disk() { current = nullptr; }
    Disk(const Disk&) = delete;
    Disk& operator=(const Disk&) = delete;
    [[nodiscard]] int flush(int file) const { return flush_(file); }
    static inline const Disk* current = nullptr;

  private:
    std::function<int(int file)> flush_;
};

}  // namespace

// In the place of the system's.
extern "C" int fsync(int file) {
    if (!Disk::current) return fdatasync(file);
    errno = Disk::current->flush(file);
    return errno == 0 ? 0 : -1;
}

TEST_SUITE("bake/write_file") {
    TEST_CASE("no folder, a folder, a full device: an error that names the path and the system's reason") {
        const Folder folder;
        const auto nowhere = write(folder.file("no/such/file"), "x");
        REQUIRE_FALSE(nowhere);
        CHECK(error_of(nowhere).code == ErrorCode::io);
        CHECK(error_of(nowhere).message.find("no/such/file: cannot create: No such file") != std::string::npos);
        std::filesystem::create_directory(folder.file("folder"));
        CHECK_FALSE(write(folder.file("folder"), "x"));
        const auto full = write("/dev/full", "x");
        REQUIRE_FALSE(full);
        CHECK(error_of(full).message.find("/dev/full: cannot write: No space left") != std::string::npos);
        CHECK(write("/dev/null", "x"));
        int ends[2];
        REQUIRE(pipe(ends) == 0);
        CHECK(write("/proc/self/fd/" + std::to_string(ends[1]), "through a pipe"));
        char block[32] = {};
        CHECK(read(ends[0], block, sizeof block) == 14);
        close(ends[0]);
        close(ends[1]);
        CHECK(folder.count() == 1);
    }

    TEST_CASE("a path that goes on after a zero byte is refused, not cut there") {
        const Folder folder;
        const auto cut = write(folder.file("old") + std::string("\0.new", 5), "x");
        REQUIRE_FALSE(cut);
        CHECK(error_of(cut).code == ErrorCode::invalid_argument);
        CHECK(folder.count() == 0);
    }

    TEST_CASE("a write to a full disk leaves the old file, and no other file") {
        const Folder folder;
        const std::string path = folder.file("scene");
        REQUIRE(write(path, "old"));
        CHECK(in_child([&] {
                  std::signal(SIGXFSZ, SIG_IGN);
                  limit_file_size(65'536);
                  const auto written = write(path, filled(0));
                  return !written && written.error().message.find("cannot write: File too large") != std::string::npos
                             ? 0
                             : 1;
              }) == 0);
        CHECK(contents(path) == "old");
        CHECK(folder.count() == 1);
        // Here the system ends the process in the middle of the write.
        CHECK(in_child([&] {
                  std::signal(SIGXFSZ, SIG_DFL);
                  limit_file_size(65'536);
                  return write(path, filled(0)) ? 0 : 1;
              }) == -1);
        CHECK(contents(path) == "old");
        REQUIRE(write(path, "new"));
        CHECK(contents(path) == "new");
        CHECK(folder.count() == 1);
    }

    TEST_CASE("a writer killed at any moment leaves a whole file, and the next one cleans up") {
        const Folder folder;
        const std::string path = folder.file("scene");
        REQUIRE(write(path, filled(0)));
        int left_behind = 0;
        for (int i = 0; i < testing::kill_count(); ++i) {
            CHECK(
                testing::kill_while_writing([&](std::uint64_t round) { return write(path, filled(round)).has_value(); },
                                            static_cast<std::uint64_t>(i), 8000));
            CHECK(is_filled(contents(path)));
            left_behind += folder.count() > 1;
            if (i % 5 != 4) continue;  // leftovers of several writers at once
            REQUIRE(write(path, filled(3)));
            CHECK(contents(path) == filled(3));
            CHECK(folder.count() == 1);
        }
        MESSAGE(left_behind << " of " << testing::kill_count() << " kills left a .partial behind");
    }

    TEST_CASE("a reader keeps the contents that it has open or mapped when the file is written again") {
        const Folder folder;
        const std::string path = folder.file("scene");
        REQUIRE(write(path, filled(1)));
        const auto mapped = bake::MappedFile::open(path).value();
        REQUIRE(write(path, "short"));
        CHECK(
            std::all_of(mapped.bytes().begin(), mapped.bytes().end(), [](std::byte b) { return b == std::byte{'b'}; }));
        CHECK(contents(path) == "short");
    }

    TEST_CASE("links stay links, permissions stay, and a pipe in the place of the temporary file is refused") {
        const Folder folder;
        const std::string path = folder.file("scene"), link = folder.file("link");
        REQUIRE(write(path, "old"));
        REQUIRE(chmod(path.c_str(), 0640) == 0);
        std::filesystem::create_symlink("scene", link);
        REQUIRE(write(link, "new"));
        CHECK(std::filesystem::is_symlink(link));
        CHECK(contents(path) == "new");
        struct stat status {};
        REQUIRE(stat(path.c_str(), &status) == 0);
        CHECK((status.st_mode & 0777) == 0640);
        REQUIRE(mkfifo((path + ".partial").c_str(), 0600) == 0);
        const auto refused = write(path, "newer");
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).message.find(".partial is in the way") != std::string::npos);
        CHECK(contents(path) == "new");
        std::filesystem::remove(path + ".partial");
        const std::string victim = folder.file("victim");
        REQUIRE(write(victim, "mine"));
        std::filesystem::create_symlink("victim", path + ".partial");
        CHECK_FALSE(write(path, "newer"));
        CHECK(contents(victim) == "mine");
    }

    TEST_CASE("several writers of one path: each writes whole files, the last one stays") {
        const Folder folder;
        const std::string path = folder.file("scene");
        std::vector<std::thread> threads;
        std::vector<int> failures(4, 0);
        for (std::size_t t = 0; t < failures.size(); ++t)
            threads.emplace_back([&, t] {
                for (std::uint64_t i = 0; i < 20; ++i) failures[t] += !write(path, filled(5 * t + i));
            });
        for (std::thread& thread : threads) thread.join();
        CHECK(failures == std::vector<int>(4, 0));
        CHECK(is_filled(contents(path)));
        CHECK(folder.count() == 1);
    }

    TEST_CASE("a name without a folder is written where the program stands, a link in a circle is replaced") {
        const Folder folder;
        {
            const Standing standing(folder.path);
            REQUIRE(write("scene", "text"));
            CHECK(contents("scene") == "text");
        }
        CHECK(contents(folder.file("scene")) == "text");
        CHECK(folder.count() == 1);
        const std::string circle = folder.file("circle");
        std::filesystem::create_symlink("circle", circle);
        REQUIRE(write(circle, "new"));
        CHECK_FALSE(std::filesystem::is_symlink(circle));
        CHECK(contents(circle) == "new");
        CHECK(folder.count() == 2);
    }

    TEST_CASE("a folder that may be written and not read is written to, a socket is refused and stays") {
        const Folder folder;
        REQUIRE(chmod(folder.path.c_str(), 0333) == 0);
        {
            const AsNobody nobody;
            CHECK_FALSE(std::ifstream(folder.path).is_open());
            CHECK(write(folder.file("scene"), "text"));
        }
        REQUIRE(chmod(folder.path.c_str(), 0700) == 0);
        CHECK(contents(folder.file("scene")) == "text");

        const std::string path = folder.file("socket");
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        REQUIRE(path.size() < sizeof address.sun_path);
        std::copy(path.begin(), path.end(), address.sun_path);
        const int listener = socket(AF_UNIX, SOCK_STREAM, 0);
        REQUIRE(listener >= 0);
        REQUIRE(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
        const auto refused = write(path, "text");
        close(listener);
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).code == ErrorCode::io);
        CHECK(error_of(refused).message.find("cannot open") != std::string::npos);
        CHECK(std::filesystem::is_socket(path));
    }

    TEST_CASE("the bytes are on the disk before the file takes its place, and then the name is") {
        const Folder folder;
        const std::string path = folder.file("scene");
        for (const std::string text : {"first", "second"}) {
            const std::string before = contents(path);
            std::vector<std::string> flushed;
            const Disk disk([&](int file) {
                struct stat status {
                }, place{};
                REQUIRE(fstat(file, &status) == 0);
                REQUIRE(stat(folder.path.c_str(), &place) == 0);
                flushed.push_back((status.st_ino == place.st_ino ? "folder of " : "file beside ") + contents(path));
                if (S_ISREG(status.st_mode)) CHECK(status.st_size == static_cast<off_t>(text.size()));
                return 0;
            });
            REQUIRE(write(path, text));
            CHECK(flushed == std::vector<std::string>{"file beside " + before, "folder of " + text});
        }
    }

    TEST_CASE("files that are flushed later are whole at once, and flushed once each, then their folder") {
        const Folder folder;
        const std::vector<std::string> paths{folder.file("first"), folder.file("second")};
        std::vector<std::string> flushed;
        int reason = 0;
        const Disk disk([&](int file) {
            struct stat status {};
            REQUIRE(fstat(file, &status) == 0);
            flushed.push_back(S_ISDIR(status.st_mode) ? "folder" : std::to_string(status.st_size));
            return S_ISDIR(status.st_mode) ? 0 : reason;
        });
        for (const std::string& path : paths) {
            REQUIRE(write(path, "old"));
            flushed.clear();
            REQUIRE(bake::write_file(path, std::as_bytes(std::span(std::string_view(path))), bake::Flush::later));
            CHECK(contents(path) == path);
            CHECK(flushed.empty());
        }
        CHECK(folder.count() == 2);
        REQUIRE(bake::flush_files(paths));
        CHECK(flushed ==
              std::vector<std::string>{std::to_string(paths[0].size()), std::to_string(paths[1].size()), "folder"});
        flushed.clear();
        reason = EIO;
        const auto failed = bake::flush_files(paths);
        REQUIRE_FALSE(failed);
        CHECK(error_of(failed).message.find("first: cannot write: ") != std::string::npos);
        CHECK(flushed.size() == 3);
        CHECK(error_of(bake::flush_files(std::vector{folder.file("none")})).message.find("none: cannot open") !=
              std::string::npos);
        flushed.clear();
        reason = 0;
        CHECK_FALSE(bake::flush_files(std::vector{std::string("a\0b", 3), paths[1]}));
        CHECK(flushed.size() == 2);  // the file after the bad path, and its folder
    }

    TEST_CASE("a failing disk is an error and the old file stays, and a disk that cannot flush is written to") {
        const Folder folder;
        const std::string path = folder.file("scene");
        REQUIRE(write(path, "old"));
        int reason = EIO;
        const Disk disk([&](int) { return reason; });
        const auto failed = write(path, "new");
        REQUIRE_FALSE(failed);
        CHECK(error_of(failed).message.find(std::string("cannot write: ") + std::strerror(EIO)) != std::string::npos);
        CHECK(contents(path) == "old");
        CHECK(folder.count() == 1);
        for (const int harmless : {EINVAL, EROFS}) {
            reason = harmless;
            REQUIRE(write(path, std::to_string(harmless)));
            CHECK(contents(path) == std::to_string(harmless));
        }
    }

    TEST_CASE("a link to a file that is not there yet stays a link, and so does one that leads to it") {
        const Folder folder;
        const std::string link = folder.file("link"), first = folder.file("first");
        std::filesystem::create_symlink("later", link);
        std::filesystem::create_symlink(link, first);
        REQUIRE(write(first, "new"));
        CHECK(std::filesystem::is_symlink(first));
        CHECK(std::filesystem::is_symlink(link));
        CHECK(contents(folder.file("later")) == "new");
        REQUIRE(write(link, "newer"));
        CHECK(std::filesystem::is_symlink(link));
        CHECK(contents(folder.file("later")) == "newer");
        CHECK(folder.count() == 3);
    }
}
