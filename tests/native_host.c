/* A host without Python: loads an FMU's library, runs it, and writes its outputs as hexadecimal floats.

   native_host LIBRARY GUID STEPS STEP N_OUTPUTS FIRST_OUTPUT < values
   values: how many parameters; type (r, i or b), reference and value of each; then 10 inputs a step.
   With a seventh argument "threads" two instances run at the same time in two threads; both must give the same bits. */
#ifdef _WIN32
#include <windows.h>
#define dlopen(path, how) ((void *)LoadLibraryA(path))
#define dlsym(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define dlerror() "the library cannot be loaded"
#else
#include <dlfcn.h>
#include <pthread.h>
#endif
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define N_INPUTS 10
#define MOST 64

static struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2SetupExperimentTYPE *setup;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetRealTYPE *set_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2SetBooleanTYPE *set_boolean;
    fmi2GetRealTYPE *get_real;
    fmi2DoStepTYPE *step;
    fmi2TerminateTYPE *terminate;
    fmi2FreeInstanceTYPE *free;
} fmu;

static const char *guid;
static int steps, n_outputs;
static unsigned first_output;
static double size, *inputs;
static int n_parameters;
static struct {
    char type;
    fmi2ValueReference reference;
    double value;
} *parameters;
static long taken; /* blocks of memory that instances hold */

static void logger(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String text, ...)
{
    va_list arguments;
    (void)e, (void)status, (void)category;
    va_start(arguments, text);
    fprintf(stderr, "%s: ", name);
    vfprintf(stderr, text, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

static void *take(size_t n, size_t bytes)
{
    __atomic_add_fetch(&taken, 1, __ATOMIC_SEQ_CST);
    return calloc(n, bytes);
}

static void give_back(void *memory)
{
    __atomic_sub_fetch(&taken, memory != NULL, __ATOMIC_SEQ_CST);
    free(memory);
}

static void must(fmi2Status status, const char *call)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s: status %d\n", call, status);
        exit(1);
    }
}

static void *run(void *result)
{
    static const fmi2CallbackFunctions callbacks = {logger, take, give_back, NULL, NULL};
    fmi2ValueReference in[N_INPUTS], out[MOST];
    for (unsigned k = 0; k < N_INPUTS; k++)
        in[k] = k;
    for (unsigned k = 0; k < MOST; k++)
        out[k] = first_output + k;
    fmi2Component c = fmu.instantiate("host", fmi2CoSimulation, guid, "file:///", &callbacks, 0, 0);
    if (!c)
        exit(1);
    must(fmu.setup(c, 0, 0.0, 0.0, 0, 0.0), "setupExperiment");
    for (int k = 0; k < n_parameters; k++) {
        fmi2Integer whole = (fmi2Integer)parameters[k].value;
        fmi2ValueReference *vr = &parameters[k].reference;
        if (parameters[k].type == 'r')
            must(fmu.set_real(c, vr, 1, &parameters[k].value), "setReal");
        else
            must((parameters[k].type == 'i' ? fmu.set_integer : fmu.set_boolean)(c, vr, 1, &whole), "setInteger or setBoolean");
    }
    must(fmu.set_real(c, in, N_INPUTS, inputs), "setReal");
    must(fmu.enter(c), "enterInitializationMode");
    must(fmu.leave(c), "exitInitializationMode");
    for (int k = 0; k < steps; k++) {
        must(fmu.set_real(c, in, N_INPUTS, inputs + (size_t)k * N_INPUTS), "setReal");
        must(fmu.step(c, k * size, size, 1), "doStep");
        must(fmu.get_real(c, out, (size_t)n_outputs, (double *)result + (size_t)k * (size_t)n_outputs), "getReal");
    }
    must(fmu.terminate(c), "terminate");
    fmu.free(c);
    return NULL;
}

static void *symbol(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "%s: not in the library\n", name);
        exit(1);
    }
    return found;
}

int main(int n, char **arguments)
{
    if (n < 7)
        return 2;
    void *library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    guid = arguments[2];
    steps = atoi(arguments[3]);
    size = atof(arguments[4]);
    n_outputs = atoi(arguments[5]);
    first_output = (unsigned)atoi(arguments[6]);
    if (scanf("%d", &n_parameters) != 1)
        return 2;
    parameters = calloc((size_t)n_parameters + 1, sizeof *parameters);
    for (int k = 0; k < n_parameters; k++)
        if (scanf(" %c %u %lf", &parameters[k].type, &parameters[k].reference, &parameters[k].value) != 3)
            return 2;
    inputs = calloc((size_t)steps * N_INPUTS, sizeof *inputs);
    for (int k = 0; k < steps * N_INPUTS; k++)
        if (scanf("%lf", &inputs[k]) != 1)
            return 2;
    fmu.instantiate = symbol(library, "fmi2Instantiate");
    fmu.setup = symbol(library, "fmi2SetupExperiment");
    fmu.enter = symbol(library, "fmi2EnterInitializationMode");
    fmu.leave = symbol(library, "fmi2ExitInitializationMode");
    fmu.set_real = symbol(library, "fmi2SetReal");
    fmu.set_integer = symbol(library, "fmi2SetInteger");
    fmu.set_boolean = symbol(library, "fmi2SetBoolean");
    fmu.get_real = symbol(library, "fmi2GetReal");
    fmu.step = symbol(library, "fmi2DoStep");
    fmu.terminate = symbol(library, "fmi2Terminate");
    fmu.free = symbol(library, "fmi2FreeInstance");
    size_t numbers = (size_t)steps * (size_t)n_outputs;
    double *one = calloc(numbers, sizeof *one), *two = calloc(numbers, sizeof *two);
    (void)two;
#ifndef _WIN32
    pthread_t thread;
    int both = n > 7 && strcmp(arguments[7], "threads") == 0;
    if (both && pthread_create(&thread, NULL, run, two))
        return 1;
#endif
    run(one);
#ifndef _WIN32
    if (both && (pthread_join(thread, NULL) || memcmp(one, two, numbers * sizeof *one) != 0)) {
        fprintf(stderr, "two threads: different results\n");
        return 1;
    }
#endif
    if (taken != 0) {
        fprintf(stderr, "memory: %ld blocks were not given back\n", taken);
        return 1;
    }
    for (size_t k = 0; k < numbers; k++)
        printf("%a\n", one[k]);
    return 0;
}
