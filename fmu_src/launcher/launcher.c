/* The library of a pythonfmu FMU: takes FMI's calls, mends them where pythonfmu's wrapper would fall, and hands them on.

   What the wrapper does with them by itself: errors that a host can mend are fatal; messages of its own have no category; of a URI it
   understands "file://" and "%20"; NULL and texts that are no UTF-8 crash it; a state that is saved over another one, or freed, is
   leaked, or left to be used again; of a buffer it reads as much as the host has room for.  No rule of the model is here. */
#define _GNU_SOURCE
#include <ctype.h>
#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include "launcher.h"

#include "log.h"
#include "place.h"

typedef struct {
    Log log;
    fmi2CallbackFunctions call; /* what pythonfmu gets; it keeps the pointer */
    fmi2Component inner;
    char *name;
    int told; /* whether the slave has said what is wrong in this call */
    int stepped;
} Launched;

#define FMI_CALLS(X)                                                                                                                      \
    X(Instantiate) X(FreeInstance) X(SetupExperiment) X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset)          \
    X(GetReal) X(GetInteger) X(GetBoolean) X(GetString) X(SetReal) X(SetInteger) X(SetBoolean) X(SetString) X(GetFMUstate)                \
    X(SetFMUstate) X(FreeFMUstate) X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate) X(DoStep) X(GetRealStatus)

static struct {
    void *library;
#define MEMBER(Call) fmi2##Call##TYPE *Call;
    FMI_CALLS(MEMBER)
} python;

/* -- messages */

static void from_slave(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String text, ...)
{
    Launched *l = environment;
    int own = 0; /* the slave's own messages have a category, and are safe as formats */
    (void)name;
    for (int k = 0; category && k < N_CATEGORIES; k++)
        own |= strcmp(category, log_categories[k]) == 0;
    if (own) {
        l->told |= status == fmi2Error;
        pass_on(&l->log, status, text);
    } else if (!l->told) {
        const char *line = strchr(text, '\n'); /* before it: the wrapper's function */
        say(&l->log, status == fmi2Fatal ? fmi2Error : status, "%s", line && line[1] ? line + 1 : text);
    }
}

/* What the slave refuses, a host can mend: pythonfmu's wrapper has let go of nothing that the slave did not hold fast. */
static fmi2Status mended(fmi2Status status) { return status == fmi2Fatal ? fmi2Error : status; }

/* -- Python */

static int no_python(const Log *log) /* 0: there is one, and it can run the slave */
{
    const char *chosen = getenv("CABLE_FMU_LIBPYTHON");
    if (chosen && *chosen && !dlsym(RTLD_DEFAULT, "Py_GetVersion") && !dlopen(chosen, RTLD_NOW | RTLD_GLOBAL)) {
        say(log, fmi2Error, "CABLE_FMU_LIBPYTHON = '%s': must be the path of a libpython (%s). Correct it, or unset it.", chosen, dlerror());
        return 1;
    }
    for (int minor = 20; minor >= 11 && !dlsym(RTLD_DEFAULT, "Py_GetVersion"); minor--) {
        char name[40];
        snprintf(name, sizeof name, "libpython3.%d.so.1.0", minor);
        dlopen(name, RTLD_NOW | RTLD_GLOBAL);
    }
    void *symbol = dlsym(RTLD_DEFAULT, "Py_GetVersion");
    const char *(*version)(void);
    memcpy(&version, &symbol, sizeof version);
    if (!symbol) {
        say(log, fmi2Error, "libpython: must be found by this host. Put the folder of libpython3.11.so.1.0 or newer into LD_LIBRARY_PATH, "
                            "or its path into CABLE_FMU_LIBPYTHON, or use the native FMU.");
        return 1;
    }
    int major = 0, minor = 0;
    if (sscanf(version(), "%d.%d", &major, &minor) != 2 || major != 3 || minor < 11) {
        say(log, fmi2Error, "Python = %d.%d: must be 3.11 or newer. Run this host with such a Python, or use the native FMU.", major, minor);
        return 1;
    }
    return 0;
}

static void (*end_python)(void);

static void at_exit(void) { end_python(); }

/* Where pythonfmu's wrapper is going to start Python itself: it stays until the host ends, for numpy cannot be started twice in a
   process; and it ends before the wrapper, which otherwise ends it twice, comes to do so. */
static void start_no_second_python(void *library)
{
    void *running = dlsym(RTLD_DEFAULT, "Py_IsInitialized"), *end = library ? dlsym(library, "finalizePythonInterpreter") : NULL;
    int (*is_running)(void);
    Dl_info here = {0};
    memcpy(&is_running, &running, sizeof running);
    if (!running || is_running() || !end || !dladdr((void *)at_exit, &here))
        return;
    memcpy(&end_python, &end, sizeof end);
    dlopen(here.dli_fname, RTLD_NOW | RTLD_NODELETE);
    atexit(at_exit);
}

static int not_loaded(const Log *log) /* 0: pythonfmu's library is at hand */
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&lock);
    if (!python.library && no_python(log) == 0) {
        char path[4096];
        beside(1, INNER_LIBRARY, path);
        void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        int missing = !library;
        if (!library)
            say(log, fmi2Error, "%s: must be loadable (%s). Unzip the FMU again.", INNER_LIBRARY, dlerror());
        start_no_second_python(library);
#define FOUND(Call)                                                             \
    {                                                                           \
        void *symbol = library ? dlsym(library, "fmi2" #Call) : NULL;           \
        missing |= !symbol;                                                     \
        memcpy(&python.Call, &symbol, sizeof symbol);                           \
    }
        FMI_CALLS(FOUND)
        python.library = missing ? NULL : library;
    }
    pthread_mutex_unlock(&lock);
    return !python.library;
}

__attribute__((destructor)) static void unload(void)
{
    if (python.library && !end_python)
        dlclose(python.library);
}

/* -- life of an instance */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String uri, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    if (!functions)
        return NULL;
    Launched *l = calloc(1, sizeof *l);
    char *own = as_utf8(name), *resources = NULL;
    if (!l || !own)
        goto none;
    l->name = own;
    l->log = (Log){.logger = functions->logger, .environment = functions->componentEnvironment, .name = own};
    choose_categories(&l->log, logging != fmi2False, 1);
    const char *wrong = !*own ? "instance name: must not be empty. Give the instance a name." : NULL;
    if (type != fmi2CoSimulation)
        wrong = "type: must be fmi2CoSimulation. This FMU is no model exchange.";
    if (!guid || strcmp(guid, MODEL_GUID) != 0)
        wrong = "GUID: must be " MODEL_GUID ". The library and modelDescription.xml do not belong together.";
    if (wrong) {
        say(&l->log, fmi2Error, "%s", wrong);
        goto none;
    }
    resources = find_resources(&l->log, uri);
    if (!resources || not_loaded(&l->log))
        goto none;
    l->call = (fmi2CallbackFunctions){from_slave, functions->allocateMemory, functions->freeMemory, functions->stepFinished, l};
    l->inner = python.Instantiate(own, type, guid, resources, &l->call, visible, fmi2True);
    if (!l->inner)
        goto none;
    free(resources);
    return l;
none:
    free(resources);
    free(own);
    free(l);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c)
{
    Launched *l = c;
    if (!l)
        return;
    python.FreeInstance(l->inner);
    free(l->name);
    free(l);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return c ? set_debug_logging(&((Launched *)c)->log, on, n, categories) : fmi2Error;
}

/* Hands a call on, or refuses it where `bad`. */
#define HAND_ON(bad, text, call)                     \
    Launched *l = c;                                 \
    if (!l)                                          \
        return fmi2Error;                            \
    if (bad)                                         \
        return say(&l->log, fmi2Error, "%s", text);  \
    l->told = 0;                                     \
    return mended(python.call)

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean with_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean with_stop,
                               fmi2Real stop)
{
    HAND_ON(0, "", SetupExperiment(l->inner, with_tolerance, tolerance, start, with_stop, stop));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { HAND_ON(0, "", EnterInitializationMode(l->inner)); }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { HAND_ON(0, "", ExitInitializationMode(l->inner)); }
fmi2Status fmi2Terminate(fmi2Component c) { HAND_ON(0, "", Terminate(l->inner)); }

fmi2Status fmi2Reset(fmi2Component c)
{
    Launched *l = c;
    if (!l)
        return fmi2Error;
    l->told = l->stepped = 0;
    return python.Reset(l->inner); /* where this is fatal, there is no slave any more */
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean no_return)
{
    Launched *l = c;
    if (!l)
        return fmi2Error;
    l->told = 0;
    fmi2Status status = mended(python.DoStep(l->inner, now, step, no_return));
    l->stepped |= status == fmi2OK;
    return status;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    Launched *l = c;
    return l ? say(&l->log, fmi2Error, "step: must not be cancelled: it is never asynchronous. Wait for fmi2DoStep.") : fmi2Error;
}

/* -- values */

#define ALL_GIVEN "value references and values: must be given. Pass as many as there are."
#define VALUES(Call, type)                                                                     \
    fmi2Status fmi2##Call(fmi2Component c, const fmi2ValueReference vr[], size_t n, type v[])   \
    {                                                                                          \
        HAND_ON(n > 0 && (!vr || !v), ALL_GIVEN, Call(l->inner, vr, n, v));                    \
    }
VALUES(GetReal, fmi2Real)
VALUES(GetInteger, fmi2Integer)
VALUES(GetBoolean, fmi2Boolean)
VALUES(GetString, fmi2String)
VALUES(SetReal, const fmi2Real)
VALUES(SetInteger, const fmi2Integer)
VALUES(SetBoolean, const fmi2Boolean)

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String v[])
{
    int bad = 0;
    for (size_t k = 0; vr && v && k < n; k++)
        bad |= v[k] && !is_utf8(v[k]);
    if (c && bad)
        return say(&((Launched *)c)->log, fmi2Error, "value: must be UTF-8. Give it in that encoding.");
    HAND_ON(n > 0 && (!vr || !v), ALL_GIVEN, SetString(l->inner, vr, n, v));
}

/* -- complete state */

#define SAVED "saved state: must not be empty. Save one first."

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Launched *l = c;
    if (!l)
        return fmi2Error;
    if (state && *state)
        python.FreeFMUstate(l->inner, state);
    if (state)
        *state = NULL;
    return fmi2OK;
}

/* The state that a host gets takes the place of the one that it had there. */
static fmi2Status put(Launched *l, fmi2Status status, fmi2FMUstate made, fmi2FMUstate *state)
{
    if (mended(status) != fmi2OK)
        return mended(status);
    fmi2FreeFMUstate(l, state);
    *state = made;
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Launched *l = c;
    fmi2FMUstate made = NULL;
    if (!l)
        return fmi2Error;
    if (!state)
        return say(&l->log, fmi2Error, "place of the saved state: must be given. Pass the address of an fmi2FMUstate.");
    l->told = 0;
    fmi2Status status = python.GetFMUstate(l->inner, &made);
    return put(l, status, made, state);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (c)
        ((Launched *)c)->stepped = 0;
    HAND_ON(!state, SAVED, SetFMUstate(l->inner, state));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    HAND_ON(!state || !size, SAVED, SerializedFMUstateSize(l->inner, state, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte to[], size_t size)
{
    size_t wanted = 0;
    if (fmi2SerializedFMUstateSize(c, state, &wanted) != fmi2OK)
        return fmi2Error;
    Launched *l = c;
    if (size < wanted || !to)
        return say(&l->log, fmi2Error, "room for the saved state = %zu bytes: must be at least %zu. Ask fmi2SerializedFMUstateSize.",
                   to ? size : 0, wanted);
    l->told = 0;
    return mended(python.SerializeFMUstate(l->inner, state, to, wanted));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte from[], size_t size, fmi2FMUstate *state)
{
    Launched *l = c;
    fmi2FMUstate made = NULL;
    if (!l)
        return fmi2Error;
    if (!from || !state)
        return say(&l->log, fmi2Error, "saved state: must be given, and a place for it. Pass what fmi2SerializeFMUstate wrote.");
    l->told = 0;
    fmi2Status status = python.DeSerializeFMUstate(l->inner, from, size, &made);
    return put(l, status, made, state);
}

/* -- status, and what the capability flags leave out */

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    Launched *l = c;
    if (!l || !value)
        return fmi2Error;
    return kind == fmi2LastSuccessfulTime && l->stepped ? python.GetRealStatus(l->inner, kind, value) : fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!c || !value)
        return fmi2Error;
    *value = fmi2False;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

static const Log *log_of(fmi2Component c) { return &((const Launched *)c)->log; }

#include "absent.h"

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return absent(c, "fmi2SetRealInputDerivatives");
}
