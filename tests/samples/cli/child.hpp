// SPDX-License-Identifier: MIT
// The command line as a child process, which a test sends signals to.
#pragma once
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <string>
#include <vector>

namespace crofton::test {

// Standard output and standard error go into files.
class Child {
  public:
    Child(const std::vector<std::string>& arguments, const std::string& out, const std::string& err = "/dev/null") {
        pid_ = fork();
        if (pid_ != 0) return;
        const auto writing = [](const std::string& path) {
            return ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        };
        dup2(::open("/dev/null", O_RDWR), STDIN_FILENO);
        dup2(writing(out), STDOUT_FILENO);
        dup2(writing(err), STDERR_FILENO);
        std::vector<char*> list{const_cast<char*>(CROFTON_CLI)};
        for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
        list.push_back(nullptr);
        execv(CROFTON_CLI, list.data());
        _exit(127);
    }
    void signal(int number) const { ::kill(pid_, number); }
    // Gives the processor time that the child's threads have used so far, in seconds.
    [[nodiscard]] double processor_seconds() const {
        clockid_t clock{};
        timespec used{};
        if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0.0;
        return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
    }
    struct Exit {
        int status = -1;  // the exit status; −1 where a signal ended it
        double processor_seconds = 0.0;
    };
    [[nodiscard]] Exit wait() const {
        int status = 0;
        rusage used{};
        ::wait4(pid_, &status, 0, &used);
        const auto seconds = [](const timeval& time) {
            return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
        };
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds(used.ru_utime) + seconds(used.ru_stime)};
    }

  private:
    pid_t pid_;
};

}  // namespace crofton::test
