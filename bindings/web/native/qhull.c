/* SPDX-License-Identifier: MIT */
/* What Qhull leaves to its user, for this build: what it does when it is done, where its errors go, and no output. In
 * place of user_r.c, usermem_r.c, userprintf_r.c and io_r.c, as those files suggest. */
#include <stdlib.h>

#include "qhull_ra.h"

/* A hull, for the options that the library gives: corners and triangles, checked. 0, or Qhull's number of an error. */
int qh_new_qhull(qhT* qh, int dim, int count, coordT* points, boolT owned, char* options, FILE* out, FILE* errors) {
    if (!qh->qhmem.ferr) qh_meminit(qh, errors);
    qh_initqhull_start(qh, NULL, out, errors);
    const int code = setjmp(qh->errexit);
    if (code == 0) {
        qh->NOerrexit = False;
        qh_initflags(qh, options);
        qh_init_B(qh, points, count, dim, owned);
        qh_qhull(qh);
        qh_check_output(qh);
        if (qh->TRIangulate && !qh->hasTriangulation) {
            qh_triangulate(qh);
            if (qh->VERIFYoutput && !qh->CHECKfrequently) qh_checkpolygon(qh, qh->facet_list);
        }
        qh_findgood_all(qh, qh->facet_list);
        if (qh->VERIFYoutput) qh_check_points(qh);
    }
    qh->NOerrexit = True;
    return code;
}

void qh_note_message(qhT* qh, int code) {
    if (qh && code >= MSG_ERROR && code < MSG_WARNING) qh->last_errcode = code;
}
/* Before there is a state; qh_errexit or qh_exit follows. */
void qh_fprintf_stderr(int code, const char* format, ...) {
    (void)code, (void)format;
}

void qh_exit(int code) {
    (void)code;
    abort();
}
void qh_errexit(qhT* qh, int code, facetT* facet, ridgeT* ridge) {
    (void)facet, (void)ridge;
    qh->tracefacet = NULL;
    qh->traceridge = NULL;
    qh->tracevertex = NULL;
    if (qh->ERREXITcalled || qh->NOerrexit) qh_exit(code);
    qh->NOerrexit = True;
    qh->ALLOWrestart = False; /* longjmp undoes qh_build_withrestart */
    longjmp(qh->errexit, code ? code : qh_ERRother);
}

void* qh_malloc(size_t size) {
    return malloc(size);
}
void qh_free(void* memory) {
    free(memory);
}
void qh_user_memsizes(qhT* qh) {
    (void)qh;
}

/* What would be printed. */
void qh_errprint(qhT* qh, const char* text, facetT* facet, facetT* other, ridgeT* ridge, vertexT* vertex) {
    (void)qh, (void)text, (void)facet, (void)other, (void)ridge, (void)vertex;
}
void qh_printfacet(qhT* qh, FILE* file, facetT* facet) {
    (void)qh, (void)file, (void)facet;
}
void qh_printfacetlist(qhT* qh, facetT* list, setT* facets, boolT all) {
    (void)qh, (void)list, (void)facets, (void)all;
}
void qh_printhelp_narrowhull(qhT* qh, FILE* file, realT angle) {
    (void)qh, (void)file, (void)angle;
}
void qh_printpoint(qhT* qh, FILE* file, const char* text, pointT* point) {
    (void)qh, (void)file, (void)text, (void)point;
}
void qh_printridge(qhT* qh, FILE* file, ridgeT* ridge) {
    (void)qh, (void)file, (void)ridge;
}
void qh_printvertexlist(qhT* qh, FILE* file, const char* text, facetT* list, setT* facets, boolT all) {
    (void)qh, (void)file, (void)text, (void)list, (void)facets, (void)all;
}

/* Options name no files. */
char* qh_skipfilename(qhT* qh, char* name) {
    (void)qh;
    return name;
}
void qh_copyfilename(qhT* qh, char* name, int size, const char* source, int length) {
    (void)qh, (void)size, (void)source, (void)length;
    name[0] = 0;
}
