// SPDX-License-Identifier: MIT
// The command line as a child process, which a test sends signals to.
#pragma once
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
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
    // The exit status; −1 where a signal ended it.
    [[nodiscard]] int wait() const {
        int status = 0;
        ::waitpid(pid_, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

  private:
    pid_t pid_;
};

}  // namespace crofton::test
