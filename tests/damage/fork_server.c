/* SPDX-License-Identifier: MIT
 * Runs a program's main again and again, each time in a new process, without loading the program anew.
 *
 * damage.py puts this library before a program (LD_PRELOAD). The program is loaded, its static objects are made, and
 * instead of main the loop below runs. Each line on descriptor 3 has a file for standard error and main's arguments,
 * separated by tabs. A child process calls main with them. Its status and largest memory, as wait4 gives them, are the
 * answer on descriptor 4. A child that takes CROFTON_SERVER_SECONDS by the clock is ended by SIGALRM. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { from_tests = 3, to_tests = 4, most_arguments = 62 };

typedef int (*Main)(int, char**, char**);
typedef int (*Start)(Main, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);

int __libc_start_main(Main program, int count, char** values, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end);

static Main the_main;

static void be_program(char* name, char* line, char** environment) {
    char* values[most_arguments + 2] = {name};
    char* errors = strsep(&line, "\t");
    int count = 1;
    while (line && count <= most_arguments) {
        values[count++] = strsep(&line, "\t");
    }
    close(from_tests);
    close(to_tests);
    dup2(open("/dev/null", O_RDWR), STDIN_FILENO);
    dup2(STDIN_FILENO, STDOUT_FILENO);
    dup2(open(errors, O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    const char* seconds = getenv("CROFTON_SERVER_SECONDS");
    alarm(seconds ? (unsigned)atoi(seconds) : 10);
    exit(the_main(count, values, environment));
}

static int serve(int count, char** values, char** environment) {
    FILE* tasks = fdopen(from_tests, "r");
    char* line = NULL;
    size_t size = 0;
    ssize_t length;
    (void)count;
    unsetenv("LD_PRELOAD"); /* the sanitizer's symbolizer is another program */
    if (!tasks) {
        return 99;
    }
    while ((length = getline(&line, &size, tasks)) > 0) {
        struct rusage usage;
        int status;
        const pid_t child = fork();
        line[length - 1] = '\0';
        if (child == 0) {
            be_program(values[0], line, environment);
        }
        if (child < 0 || wait4(child, &status, 0, &usage) < 0 ||
            dprintf(to_tests, "%d %ld\n", status, usage.ru_maxrss) < 0) {
            return 99;
        }
    }
    free(line);
    fclose(tasks);
    return 0;
}

int __libc_start_main(Main program, int count, char** values, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end) {
    const Start start = (Start)dlsym(RTLD_NEXT, "__libc_start_main");
    the_main = program;
    return start(serve, count, values, init, fini, rtld_fini, stack_end);
}
