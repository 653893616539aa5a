#include <doctest/doctest.h>

#include "run_cli.hpp"

using namespace crofton::test;

TEST_SUITE("cli/usage") {
    TEST_CASE("without a sub-command, or with one that does not exist, the exit status is 2 and stdout stays empty") {
        for (const char* arguments : {"", "no-such-command", "--no-such-option"}) {
            const CliRun run = run_cli(arguments);
            CHECK(run.status == 2);
            CHECK(run.out.empty());
            CHECK_FALSE(run.err.empty());
        }
    }

    TEST_CASE("--version and --help answer on stdout and succeed") {
        CHECK(run_cli("--version").out.find("crofton 0.") == 0);
        CHECK(run_cli("--version").status == 0);
        const CliRun help = run_cli("--help");
        CHECK(help.status == 0);
        CHECK(help.out.find("verify") != std::string::npos);
    }
}
