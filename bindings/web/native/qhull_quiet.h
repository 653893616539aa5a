/* SPDX-License-Identifier: MIT */
/* Included before every source of Qhull in this build: without messages and tracing, a third of its code. Nobody would
 * read them: the package has no files, and the library gives errors of its own. */
#ifndef CROFTON_QHULL_QUIET_H
#define CROFTON_QHULL_QUIET_H
#define qh_NOtrace
/* The declaration in Qhull's header becomes that of qh_note_message, as each call does. */
#define qh_fprintf(qh, file, code, ...) qh_note_message(qh, code)
#endif
