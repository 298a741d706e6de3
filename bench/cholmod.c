/* Times CHOLMOD itself, without a Python layer: analyse, factor, solve for three right-hand sides.
 *
 * Built by `make bench` into a shared library that `springform bench` loads. Chen, Davis, Hager &
 * Rajamanickam, "Algorithm 887: CHOLMOD", 2008.
 *
 * Within the clock: ordering and symbolic analysis, numeric factorisation, solution. Outside: setting up the
 * matrix, freeing results, the first call of a process. The workspace of the library and of the
 * solution is kept between repeats. */
#include <cholmod.h>
#include <stdint.h>
#include <time.h>

enum { STAGES = 3, SIDES = 3 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void quiet(int status, const char *file, int line, const char *message) {
    (void)status, (void)file, (void)line, (void)message;
}

/* version[3] of the library that was loaded. */
void reference_version(int version[3]) { cholmod_version(version); }

/* Factors and solves a symmetric matrix `repeats` times.
 *
 * size: rows; starts (size + 1), rows, values: its lower triangle by columns, rows ascending.
 * sides, solution: SIDES columns of `size` numbers.
 * metis, supernodal: which ordering and which factorisation.
 * seconds: STAGES numbers a repeat: analyse, factor, solve.
 * fill: entries of the factor.
 * Returns 0, or CHOLMOD's status if it refuses the matrix. */
int reference_run(int size, const int *starts, const int *rows, const double *values, const double *sides,
                  int metis, int supernodal, int repeats, double *seconds, double *solution, double *fill) {
    cholmod_common common;
    cholmod_start(&common);
    common.error_handler = quiet;
    common.nmethods = 1;
    common.method[0].ordering = metis ? CHOLMOD_METIS : CHOLMOD_AMD;
    common.postorder = 1;
    common.supernodal = supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;
    cholmod_sparse matrix = {.nrow = (size_t)size, .ncol = (size_t)size, .nzmax = (size_t)starts[size],
                             .p = (void *)(uintptr_t)starts, .i = (void *)(uintptr_t)rows,
                             .x = (void *)(uintptr_t)values, .stype = -1, .itype = CHOLMOD_INT,
                             .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE, .sorted = 1, .packed = 1};
    cholmod_dense right = {.nrow = (size_t)size, .ncol = SIDES, .nzmax = SIDES * (size_t)size,
                           .d = (size_t)size, .x = (void *)(uintptr_t)sides, .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    cholmod_dense *found = NULL, *first = NULL, *second = NULL;
    int status = CHOLMOD_OK;
    for (int repeat = 0; repeat < repeats && status == CHOLMOD_OK; repeat++) {
        double *stage = seconds + STAGES * repeat;
        double began = now();
        cholmod_factor *factor = cholmod_analyze(&matrix, &common);
        double analysed = now();
        if (factor != NULL) {
            cholmod_factorize(&matrix, factor, &common);
        }
        double factored = now();
        if (common.status == CHOLMOD_OK) {
            cholmod_solve2(CHOLMOD_A, factor, &right, NULL, &found, NULL, &first, &second, &common);
        }
        double solved = now();
        stage[0] = analysed - began, stage[1] = factored - analysed, stage[2] = solved - factored;
        *fill = common.lnz;
        status = common.status;
        cholmod_free_factor(&factor, &common);
    }
    if (status == CHOLMOD_OK) {
        const double *x = found->x;
        for (size_t at = 0; at < SIDES * (size_t)size; at++) {
            solution[at] = x[at];
        }
    }
    cholmod_free_dense(&found, &common);
    cholmod_free_dense(&first, &common);
    cholmod_free_dense(&second, &common);
    cholmod_finish(&common);
    return status;
}
